// The vertex nearest to a point, by a walk on the Delaunay graph, or by a tree of the vertices.
//
// A vertex that is not the nearest has a neighbour in the graph that is nearer, so going on to
// nearer ones ends at the nearest. That holds for ties as well: of several at one distance the
// lexicographically least counts as nearest, as if the point were moved towards it by
// infinitesimally little. The walk begins at a corner of the triangle that contains the point, and
// mostly ends there. A neighbour is nearer only if its direction is less than a right angle from
// that of the point: so around the first vertex, to both sides of the triangle, others are not
// looked at. Where a walk takes long, as around a vertex of many triangles, a search in the tree
// takes O(log n) steps, unless many vertices are about as near: as sqrt(n) near the middle of a
// circle.
#pragma once

#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/triangulated.hpp"
#include "sorting/kd_tree.hpp"

namespace liftmesh {

// Of a finite point in a closed triangle, or anywhere, if that is negative. `unfinished` if the
// steps do not suffice.
std::int32_t nearest_vertex(const Triangulated& mesh, Point query, std::int32_t simplex,
                            std::size_t& steps);

// Of the positions of vertices when it was made, multiplied by a power of two that keeps squares of
// distances among the doubles.
class NearestTree {
 public:
    NearestTree(const Triangulated& mesh, Patience& patience)
        : NearestTree(Vertices(mesh, patience), patience) {}

    // The same, from any vertex on.
    std::int32_t nearest(const Triangulated& mesh, Point query, std::int32_t start) const;

 private:
    struct Vertices {
        Vertices(const Triangulated& mesh, Patience& patience);

        std::vector<Point> places;  // of all rows
        std::vector<Row> rows;
        double scale;
    };
    NearestTree(const Vertices& vertices, Patience& patience)
        : scale_(vertices.scale), tree_(vertices.places, vertices.rows, &patience) {}

    double scale_;
    KdTree tree_;
};

// Whether p is nearer to the point than q, or at the same distance and lexicographically less.
bool is_nearer(Point p, Point q, Point query);

}  // namespace liftmesh
