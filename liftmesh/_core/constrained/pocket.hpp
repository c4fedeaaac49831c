// Fills one side of the cavity that a constraint leaves.
#pragma once

#include "delaunay/mesh.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh::constrained {

// Where triangles are: the arrays of a mesh, and the slots that may be filled.
struct Ground {
    const Point* points;
    Vertex* vertices;
    Edge* twins;
    Edge* corner;  // of each vertex, an edge opposite to it
    std::vector<TriangleId> free;
};

// A chain of vertices, counter-clockwise from one end of the constraint to the other; the
// constraint itself is the last side. A vertex at which an edge ends in the cavity is in the chain
// each time that the chain passes it.
//
// A pocket is triangulated by insertion (after Shewchuk and Brown, "Fast segment insertion and
// incremental construction of constrained Delaunay triangulations", 2015): corners are cut off, in
// random order where they are many, until a triangle is left, and come back in the opposite order.
// A corner may go if it is convex. Each vertex of the chain sees the constraint, along an edge that
// the constraint crossed; these lines of sight do not cross each other, nor the chain; and the
// triangle that is cut off with a convex corner lies between those of its neighbours. So what is
// left is a simple polygon with the same property, and the corner that comes back sees the side on
// which it stands. Of the corners farthest from the constraint one is convex: there is always one
// that may go.
class Pocket {
 public:
    void clear() { chain_.clear(); }
    void add(Vertex v) { chain_.push_back(v); }
    void reverse() { std::reverse(chain_.begin(), chain_.end()); }
    std::size_t sides() const { return chain_.size(); }
    // Room for so many vertices: then filling takes no memory.
    void reserve(std::size_t vertices);

    // Takes slots of the ground for its triangles: two fewer than it has sides.
    void fill(Ground& ground, Guard guard);

    // After that: the edge of the triangle at a side, which has no twin yet. Side i is between
    // vertices i and i + 1; the last is the constraint.
    Edge side(std::size_t i) const { return side_[i]; }

 private:
    using Index = std::uint32_t;

    // In place of a twin: a side of the polygon.
    static constexpr Word open = Word{1} << 31;  // names of edges are less

    struct Link {
        Index next, previous;
    };

    struct Border {
        Vertex tail, head;
        Word beyond;
    };

    void link();
    bool is_convex(Index i) const;
    Link cut(Index i);
    void cut_short_chain(std::size_t many);
    void cut_corners();
    std::span<const Index> draw(std::span<const Index> some);
    void list(Index i);
    [[gnu::always_inline]] inline void foresee(std::size_t restored) const;
    void restore(Index i);
    bool conflicts(TriangleId t, Point p) const;
    void dig(Point p, Edge side);
    TriangleId make(Vertex a, Vertex b, Vertex c);
    void connect(Edge e, Word beyond);

    Ground* ground_ = nullptr;
    Guard guard_ = Guard::in_window();
    std::vector<Vertex> chain_;
    std::vector<Edge> side_;
    std::vector<Link> link_;
    std::vector<Point> at_;             // as of the chain
    std::vector<Index> round_, later_;  // the corners to look at, and those of the next round
    std::size_t later_count_ = 0;
    std::vector<std::uint8_t> is_listed_;  // for one of these; the ends always
    std::uint64_t draws_ = 0;
    std::array<Index, 64> drawn_{};
    std::vector<Index> order_;  // of the corners that went
    std::vector<Word> stack_;
    std::vector<Border> border_;
};

}  // namespace liftmesh::constrained
