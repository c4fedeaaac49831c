// Hubs: the vertices of so many triangles that going around one takes long. For each of them this
// table holds the first of its triangles, which is the answer to a query at the vertex.
//
// All vertices together have three corners for each triangle, so that the table has at most n / 10
// entries.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/status.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

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
