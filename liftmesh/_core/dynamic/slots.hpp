// The triangles of a triangulation that changes: as in delaunay/mesh.hpp, with edges, twins and
// ghosts named as there, but in arrays that grow, and with a list of the slots that are free. Edges
// may be marked, on both sides; without marks there is no memory for them.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"
#include "constrained/insertion.hpp"
#include "delaunay/mesh.hpp"

namespace liftmesh::dynamic {

inline constexpr Word nothing = ~Word{0};

// Room for so many in all; memory grows by doubling.
template <class T>
void make_room(std::vector<T>& values, std::size_t count) {
    if (values.capacity() < count) values.reserve(std::max(count, 2 * values.capacity()));
}

class Slots {
 public:
    Vertex apex(Edge e) const { return vertices_[e]; }
    Edge twin(Edge e) const { return twins_[e]; }
    Vertex vertex(TriangleId t, unsigned k) const { return vertices_[t + k]; }
    bool is_ghost(TriangleId t) const { return vertices_[t + 2] == ghost; }
    bool is_free(TriangleId t) const { return vertices_[t] == nothing; }

    // The ends of an edge, counter-clockwise in its triangle.
    Vertex tail(Edge e) const { return vertices_[next(e)]; }
    Vertex head(Edge e) const { return vertices_[previous(e)]; }

    // Names of triangles are below this; those of real triangles, without ghosts, are so many.
    Word end() const { return static_cast<Word>(vertices_.size()); }
    std::size_t real() const { return real_; }

    // Makes room for triangles before anything changes, so that no change is left half done.
    void reserve(std::size_t triangles) {
        while (free_.size() < triangles) {
            const Word slot = end();
            make_room(free_, slot_of(slot) + 1);
            vertices_.resize(slot + words_per_triangle, nothing);
            twins_.resize(slot + words_per_triangle, nothing);
            if (has_marks()) marks_.resize(slot_of(slot) + 1);
            free_.push_back(slot);
        }
    }

    // Marks are in bytes, a bit for each edge of a triangle.
    void keep_marks() { marks_.resize(slot_of(end())); }
    bool has_marks() const { return !marks_.empty(); }
    bool is_marked(Edge e) const { return has_marks() && marks(triangle_of(e)) >> (e % 3) & 1; }
    constrained::Mark marks(TriangleId t) const { return marks_[slot_of(t)]; }
    void set_marks(TriangleId t, constrained::Mark marks) { marks_[slot_of(t)] = marks; }
    void mark(Edge e) {
        mark_side(e);
        mark_side(twin(e));
    }

    // Of a new triangle, that has those of its neighbours.
    void take_mark(Edge e) {
        if (is_marked(twin(e))) mark_side(e);
    }
    void unmark(Edge e) {
        for (const Edge side : {e, twin(e)})
            marks_[slot_of(triangle_of(side))] &=
                static_cast<constrained::Mark>(~(1u << (side % 3)));
    }

    // In a slot that is reserved. The ghost, if there is one, is the last corner.
    TriangleId make(Vertex a, Vertex b, Vertex c) {
        const TriangleId t = free_.back();
        free_.pop_back();
        const bool first = a == ghost, second = b == ghost;
        vertices_[t] = first ? b : second ? c : a;
        vertices_[t + 1] = first ? c : second ? a : b;
        vertices_[t + 2] = first ? a : second ? b : c;
        real_ += !is_ghost(t);
        return t;
    }

    void drop(TriangleId t) {
        real_ -= !is_ghost(t);
        vertices_[t] = nothing;
        free_.push_back(t);
    }

    void clear() {
        vertices_.clear();
        twins_.clear();
        free_.clear();
        marks_.clear();
        real_ = 0;
    }

    void join(Edge e, Edge f) {
        twins_[e] = f;
        twins_[f] = e;
    }

    // For what fills cavities where they are: the arrays, with those of the vertices.
    constrained::Ground ground(const Point* points, Edge* corner) {
        return {points, vertices_.data(), twins_.data(), corner, {}};
    }
    constrained::Mark* marks() { return marks_.data(); }

    [[gnu::always_inline]] void prefetch(TriangleId t) const {
        liftmesh::prefetch(vertices_.data() + t);
        liftmesh::prefetch(twins_.data() + t);
    }

    // The edge opposite a corner.
    Edge opposite(TriangleId t, Vertex v) const {
        return t + (vertices_[t + 1] == v) + 2 * (vertices_[t + 2] == v);
    }

 private:
    void mark_side(Edge e) {
        marks_[slot_of(triangle_of(e))] |= static_cast<constrained::Mark>(1u << (e % 3));
    }

    std::vector<Vertex> vertices_;
    std::vector<Edge> twins_;
    std::vector<TriangleId> free_;
    std::vector<constrained::Mark> marks_;
    std::size_t real_ = 0;
};

}  // namespace liftmesh::dynamic
