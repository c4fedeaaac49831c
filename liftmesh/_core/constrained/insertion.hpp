// Puts edges into a triangulation under construction.
#pragma once

#include "base/buffer.hpp"
#include "base/status.hpp"
#include "constrained/pocket.hpp"

namespace liftmesh {
struct Construction;
}

namespace liftmesh::constrained {

// A part of an edge between two vertices, with none in between.
struct Span {
    Vertex from, to;
};

// Bits of each triangle: bit k marks the edge opposite vertex k. The last says that the triangle is
// in the cavity that is being filled.
using Mark = std::uint8_t;
inline constexpr Mark in_cavity = 1 << 3;

class Insertion {
 public:
    Insertion(Construction& mesh, Mark* marks, Guard guard);
    Insertion(Ground ground, Mark* marks, Guard guard)
        : marks_(marks), guard_(guard), ground_(std::move(ground)) {}

    // Room for spans that cross so many triangles: then `insert` takes no memory.
    void reserve(std::size_t triangles);

    // Puts in the edge between two vertices, span by span: calls found(span, crossed), where
    // `crossed` lists the marked edges that the span crosses properly. Such a span is left out.
    template <class Found>
    void insert(Vertex a, Vertex b, Found found) {
        while (a != b) found(insert_span(a, b), crossed_);
    }

    // Marks an edge that is one of the mesh.
    bool mark_if_there(Vertex a, Vertex b);

    // The same for an edge in the finished triangulation, which is not changed; visit(triangle) is
    // called for each triangle whose inside a span meets.
    template <class Found>
    void follow(Vertex a, Vertex b, Found found) {
        while (a != b) {
            const Span span = find_span(a, b);
            found(span, crossed_, cavity_);
        }
    }

    // How many triangles the last span crossed.
    std::size_t met() const { return cavity_.size(); }
    // The last span, if it is an edge of the mesh.
    Edge along() const { return along_; }
    // The ends of an edge of the mesh.
    Span ends(Edge e) const { return {tail(e), head(e)}; }

 private:
    // A side, and another that is the other face of the same edge.
    struct Fold {
        Word side, other;
    };

    // One side of the cavity: its sides, by the edges of the triangles that are in it.
    struct Chain {
        Pocket pocket;
        std::vector<Edge> inner;  // seen from inside; later, what is beyond
        std::vector<Fold> folds;

        void begin(Vertex v) {
            pocket.clear();
            inner.clear();
            pocket.add(v);
        }
        void add(Vertex v, Edge e) {
            pocket.add(v);
            inner.push_back(e);
        }
    };
    static constexpr Word marked = Word{1} << 31;  // of a side; names of edges are less

    // What is found by turning around the end of an edge.
    enum class Way : std::uint8_t { unknown, along, across };
    class Turn;

    Vertex apex(Edge e) const { return ground_.vertices[e]; }
    Vertex tail(Edge e) const { return apex(next(e)); }
    Vertex head(Edge e) const { return apex(previous(e)); }
    Edge twin(Edge e) const { return ground_.twins[e]; }
    Point at(Vertex v) const { return ground_.points[v]; }
    bool is_marked(Edge e) const { return marks_[slot_of(triangle_of(e))] >> (e % 3) & 1; }
    void mark(Edge e) { marks_[slot_of(triangle_of(e))] |= static_cast<Mark>(1u << (e % 3)); }

    Span insert_span(Vertex& a, Vertex& b);
    Span find_span(Vertex& a, Vertex& b);
    Vertex cross(Vertex from, Vertex to, Edge e);
    void cut_out();
    void note_sides(Chain& chain);
    void fill(Chain& chain);
    void take(Edge e) { cavity_.push_back(triangle_of(e)); }

    Mark* marks_;
    Guard guard_;
    Buffer<Edge> corner_;
    Ground ground_;
    Edge along_ = 0;  // the edge that is the span, if it is there
    bool is_there_ = false;
    std::vector<TriangleId> cavity_;  // the triangles that the span crosses
    std::vector<Edge> crossed_;       // the marked edges that it crosses
    Chain left_, right_;
};

}  // namespace liftmesh::constrained
