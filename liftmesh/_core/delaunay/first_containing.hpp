// Of several triangles that contain a query, on an edge or at a vertex, the first of the arrays is
// found. (The rule for cocircular points is in predicates/incircle.hpp.) It depends on the query
// alone, not on the triangle by which it was reached.
#pragma once

#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

inline constexpr std::int32_t outside = -1, unfinished = -2;

// The first triangle that contains the query, as one that contains it knows; `outside` if it does
// not, as where the arrays were modified. Each triangle around a vertex takes one of the steps;
// `unfinished` if there are too few of them.
std::int32_t first_containing(const Triangulated& mesh, Point query, std::int32_t triangle,
                              std::size_t& steps);

// The row of the corner of the triangle at which the query lies; `outside` if it is at none.
std::int32_t vertex_at(const Triangulated& mesh, Point query, std::int32_t triangle);

// Hubs: the vertices of so many triangles that going around one takes long. For each of them this
// table holds the first of its triangles, which is the answer to a query at the vertex.
//
// All vertices together have three corners for each triangle, so that the table has at most n / 10
// entries.

class Hubs {
 public:
    static constexpr int least_degree = 64;

    Hubs(const Triangulated& mesh, Patience& patience);

    // The first triangle at a vertex; -1 if the vertex is no hub.
    std::int32_t first_triangle(std::int32_t vertex) const;

 private:
    std::vector<std::pair<std::int32_t, std::int32_t>> hubs_;  // vertex and triangle, ascending
};

}  // namespace liftmesh
