// The triangulation under construction: two flat arrays, one of vertices and one of twins, with
// three words each for a triangle. They become the rows of the result where they lie.
//
// A triangulation of k >= 2 distinct points whose hull edges carry a ghost triangle each has
// exactly 2k - 2 triangles, collinear sets included. A merge of l and r points adds two, and
// (2l - 2) + (2r - 2) + 2 = 2(l + r) - 2: so points [first, last) own the slots from 2 first to
// 2 last - 2, and the two that follow those of its left part belong to the merge. There is no
// allocator, and the layout does not depend on which thread builds which part.
//
// A triangle is named by the place of its first word, t; its edge k, which is opposite vertex k and
// runs from vertex k + 1 to vertex k + 2 (counted modulo 3), by t + k. So in one array the word at
// the name of an edge is the opposite vertex, and in the other its twin: the name of the same edge
// in the triangle across. A ghost triangle has the vertex `ghost` at place 2; for the hull edge
// tail -> head, taken counter-clockwise, it is {head, tail, ghost}.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"

namespace liftmesh {

using Word = std::uint32_t;
using TriangleId = Word;
using Edge = Word;

inline constexpr Vertex ghost = ~Vertex{0};
inline constexpr Word words_per_triangle = 3;

constexpr Edge edge(TriangleId triangle, unsigned k) {
    return triangle + k;
}
constexpr TriangleId triangle_of(Edge e) {
    return e - e % 3;
}
constexpr Edge next(Edge e) {
    return e + 1 - 3 * (e % 3 / 2);
}
constexpr Edge previous(Edge e) {
    return e - 1 + 3 * ((2 - e % 3) / 2);
}
constexpr std::size_t slot_of(TriangleId triangle) {
    return triangle / words_per_triangle;
}
constexpr TriangleId triangle_in(std::size_t slot) {
    return static_cast<TriangleId>(words_per_triangle * slot);
}

class Mesh {
 public:
    Mesh(const Point* points, Vertex* vertices, Edge* twins)
        : points_(points), vertices_(vertices), twins_(twins) {}

    Point point(Vertex v) const { return points_[v]; }
    Pair at(Vertex v) const { return pair(points_ + v); }
    Vertex apex(Edge e) const { return vertices_[e]; }
    Vertex& vertex(TriangleId t, unsigned k) { return vertices_[place(t, k)]; }
    Vertex vertex(TriangleId t, unsigned k) const { return vertices_[place(t, k)]; }
    Edge twin(Edge e) const { return twins_[e]; }
    Edge twin(TriangleId t, unsigned k) const { return twins_[place(t, k)]; }
    void join(Edge e, Edge f) {
        twins_[e] = f;
        twins_[f] = e;
    }

    // An edge that is its own twin, and one with a number in the place of its opposite vertex: for
    // triangles that are about to be replaced.
    void cut(Edge e) { twins_[e] = e; }
    bool is_cut(Edge e) const { return twins_[e] == e; }
    void name(Edge e, Word number) { vertices_[e] = number; }

    // The hull, walked by its ghosts: the twin of a ghost's edge 1 is edge 0 of the next.
    Vertex tail(TriangleId g) const { return vertex(g, 1); }
    Vertex head(TriangleId g) const { return vertex(g, 0); }
    TriangleId successor(TriangleId g) const { return twin(g, 1); }
    TriangleId predecessor(TriangleId g) const { return twin(g, 0) - 1; }
    Edge hull_edge(TriangleId g) const { return edge(g, 2); }

    void place_ghost(TriangleId g, Vertex tail, Vertex head) {
        vertex(g, 0) = head;
        vertex(g, 1) = tail;
        vertex(g, 2) = ghost;
    }
    template <class Pattern>
    void write(const Pattern& pattern, Vertex first, TriangleId t) {
        pattern.write(first, t, vertices_, twins_);
    }
    void chain(TriangleId g, TriangleId successor) { join(edge(g, 1), edge(successor, 0)); }

 private:
    // Added in the width of an address, which the processor does on the way.
    static std::size_t place(TriangleId t, unsigned k) { return std::size_t{t} + k; }

    const Point* points_;
    Vertex* vertices_;
    Edge* twins_;
};

}  // namespace liftmesh
