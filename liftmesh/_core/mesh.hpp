// The triangulation under construction: flat arrays of triangles in static slots.
//
// A triangulation of k >= 2 distinct points whose hull edges carry a ghost triangle each has
// exactly 2k - 2 triangles, collinear sets included. A merge of l and r points adds two, and
// (2l - 2) + (2r - 2) + 2 = 2(l + r) - 2: so points [first, last) own the slots from 2 first to
// 2 last - 2, and the two that follow those of its left part belong to the merge. There is no
// allocator, and the layout does not depend on who builds which part when.
//
// Edge k of a triangle faces vertex k and runs from vertex k + 1 to vertex k + 2 (counted
// modulo 3). It is named 4 * triangle + k. A ghost triangle has the vertex `ghost` at place 2; for
// the hull edge tail -> head, taken counter-clockwise, it is {head, tail, ghost}.
#pragma once

#include <cstdint>

#include "point.hpp"

namespace liftmesh {

using TriangleId = std::uint32_t;
using Edge = std::uint32_t;

inline constexpr Vertex ghost = ~Vertex{0};

struct Triangle {
    Vertex vertex[3];
    Edge twin[3];

    bool is_ghost() const { return vertex[2] == ghost; }
};

constexpr Edge edge(TriangleId triangle, unsigned k) {
    return 4 * triangle + k;
}
constexpr TriangleId triangle_of(Edge e) {
    return e >> 2;
}
constexpr unsigned place(Edge e) {
    return e & 3;
}
constexpr Edge next(Edge e) {
    return e + 1 - 3 * ((e >> 1) & 1);
}
constexpr Edge previous(Edge e) {
    return e - 1 + 3 * ((e & 3) == 0);
}

class Mesh {
 public:
    Mesh(const Point* points, Triangle* triangles) : points_(points), triangles_(triangles) {}

    Point point(Vertex v) const { return points_[v]; }
    Triangle& operator[](TriangleId t) { return triangles_[t]; }
    const Triangle& operator[](TriangleId t) const { return triangles_[t]; }

    Vertex apex(Edge e) const { return triangles_[triangle_of(e)].vertex[place(e)]; }
    Edge& twin(Edge e) { return triangles_[triangle_of(e)].twin[place(e)]; }
    void join(Edge e, Edge f) {
        twin(e) = f;
        twin(f) = e;
    }

    // The hull, walked by its ghosts.
    Vertex tail(TriangleId g) const { return triangles_[g].vertex[1]; }
    Vertex head(TriangleId g) const { return triangles_[g].vertex[0]; }
    TriangleId successor(TriangleId g) const { return triangle_of(triangles_[g].twin[1]); }
    TriangleId predecessor(TriangleId g) const { return triangle_of(triangles_[g].twin[0]); }
    Edge hull_edge(TriangleId g) const { return edge(g, 2); }

    void place_ghost(TriangleId g, Vertex tail, Vertex head) {
        triangles_[g].vertex[0] = head;
        triangles_[g].vertex[1] = tail;
        triangles_[g].vertex[2] = ghost;
    }
    void chain(TriangleId g, TriangleId successor) { join(edge(g, 1), edge(successor, 0)); }

 private:
    const Point* points_;
    Triangle* triangles_;
};

}  // namespace liftmesh
