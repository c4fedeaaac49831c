// A triangulation that takes points in and out, and at every moment is the canonical one of the
// points that are present.
//
// The rule for ties compares coordinates alone (predicates/incircle.hpp), and is a lift of all
// points of the plane into general position: which of four points is lifted how much does not
// depend on the others. So the triangles of a set are those that conflict with no other point of
// it, and
//
// - a point takes away the triangles that conflict with it, and what it leaves is its star
//   (Bowyer, Watson 1981; insertion.cpp);
// - without a point all triangles stay that do not touch it, ties included, and its star gives way
//   to triangles of its neighbours (removal.cpp).
//
// Lifted points are in convex position, so none is ever hidden: conflicts are simply connected, and
// a star has every neighbour as a vertex. Points on one line have no triangles: they are kept in
// order until one comes that is off it.
#pragma once

#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/delaunay.hpp"
#include "dynamic/slots.hpp"
#include "predicates/incircle.hpp"
#include "predicates/scale.hpp"

namespace liftmesh::dynamic {

struct Lexicographic {
    bool operator()(Point a, Point b) const { return before_xy(a, b); }
};

// Points on one line, in order.
using Line = std::map<Point, Vertex, Lexicographic>;

// Where a point is: at a vertex, or in conflict with a triangle.
struct Place {
    Vertex vertex = ghost;
    TriangleId triangle = nothing;
};

// Triangles that are to fill a hole. Edges are named as in `Slots`, from 0; the twin of one at the
// border is an edge outside, marked.
struct Patch {
    static constexpr Word outside = Word{1} << 31;  // names of edges are less
    std::vector<Vertex> vertices;
    std::vector<Word> twins;

    std::size_t count() const { return vertices.size() / words_per_triangle; }
    void clear() {
        vertices.clear();
        twins.clear();
    }
    Edge add(Vertex a, Vertex b, Vertex c) {
        const auto first = static_cast<Edge>(vertices.size());
        vertices.insert(vertices.end(), {a, b, c});
        twins.insert(twins.end(), {nothing, nothing, nothing});
        return first;
    }
    void join(Edge e, Word other) {
        twins[e] = other;
        if (!(other & outside)) twins[other] = e;
    }
};

// The star of a vertex, counter-clockwise.
struct Star {
    std::vector<TriangleId> triangles;
    std::vector<Vertex> link;  // one of them may be the ghost
    std::vector<Edge> beyond;  // across the edge from a vertex of the link to the next one
};

// An edge of a cavity's border, seen from outside it.
struct BorderEdge {
    Vertex tail, head;  // counter-clockwise around the cavity
    Edge beyond;
};

class Triangulation {
 public:
    std::size_t size() const { return size_; }
    std::size_t vertex_end() const { return points_.size(); }
    bool is_present(Vertex v) const { return v < place_.size() && place_[v] < size_; }
    Point point(Vertex v) const { return points_[v]; }
    const Slots& slots() const { return slots_; }
    bool has_triangles() const { return slots_.real() > 0; }

    // The vertex at a position, a new one if none is there. A walk to it begins at the hint.
    Vertex insert(Point p, Vertex hint = ghost);
    void remove(Vertex v);

    // Many at once: in an order of neighbourhood, or all anew where they are many. If interrupted,
    // some of them are in, or out, and the triangulation is that of the points present.
    Status insert(const Input& input, Vertex* found, Interrupt& interrupt);
    Status remove(const Vertex* vertices, std::size_t count, Interrupt& interrupt);

    // The vertex at a position, or `ghost`.
    Vertex find(Point p, Vertex hint = ghost) const;

    // Triangles over the numbers of vertices, and the hull.
    Result result() const;
    // Room for so many further points.
    void reserve(std::size_t count);

    // Brings what an insertion into a triangle will read: the triangle itself, or, once that is
    // there, its corners and neighbours.
    [[gnu::always_inline]] void prefetch(TriangleId t) const { slots_.prefetch(t); }
    void prefetch_around(TriangleId t) const;

    // The parts of an insertion, for callers that keep something by triangles: the place of a new
    // point, the cavity of triangles that conflict with it, and its star in their stead.
    Place locate(Point p, Vertex hint) const;
    void dig(Point p, TriangleId conflict);
    const std::vector<TriangleId>& cavity() const { return cavity_; }
    const std::vector<BorderEdge>& border() const { return border_; }
    const std::vector<TriangleId>& star() const { return star_triangles_; }
    Vertex fill(Point p);
    // Those of a removal, of a vertex whose neighbours are not on one line. Of a vertex with more
    // neighbours than `most`, the star is not found.
    void find_star(Vertex v, Star& star) const;
    bool find_star(Vertex v, std::size_t most, Star& star) const;
    void plan(const Star& star, Patch& patch) const;
    // `made` gets the triangles of the patch.
    void replace(Vertex v, const Star& star, const Patch& patch, std::vector<TriangleId>& made);

 private:
    Vertex add_vertex(Point p);
    void forget(Vertex v);
    bool conflicts(TriangleId t, Point p) const;
    bool is_outside(TriangleId ghost_triangle, Point p) const;
    Vertex nearest_of_sample(Point p) const;
    void connect_star(Vertex v);
    Vertex insert_on_line(Point p);
    bool is_off_line(Line::const_iterator place) const;
    void raise(Vertex apex);
    void place_ghosts();
    bool leaves_a_line(const Star& star) const;
    void lower(const Star& star);
    Status insert_anew(const Input& input, Vertex* found, Interrupt& interrupt);
    Status remove_anew(const Vertex* vertices, std::size_t count, Interrupt& interrupt);
    std::vector<bool> present() const;
    void gather(const std::vector<bool>& wanted, std::vector<Point>& points,
                std::vector<Vertex>& vertex_of_row) const;
    void prepare(const Delaunay& outcome, const std::vector<Point>& points);
    void take(const Delaunay& outcome, const std::vector<Vertex>& vertex_of_row);

    std::vector<Point> points_;
    std::vector<Edge> corner_;  // an edge opposite the vertex
    // Those that are present, in any order, and those that are free, the last one first; and where
    // each is among them.
    std::vector<Vertex> order_, place_;
    std::size_t size_ = 0;  // of those that are present
    Vertex last_ = ghost;
    Range range_;
    Guard guard_ = Guard::in_window();
    Slots slots_, fresh_;
    Line line_, fresh_line_;  // all points, while there is no triangle

    std::vector<TriangleId> cavity_;
    std::vector<BorderEdge> border_;
    std::vector<Edge> stack_;
    std::vector<TriangleId> star_triangles_;
    std::vector<Vertex> hull_;
    Star removed_;
    Patch patch_;
};

// Points as rows.
Input input_of(const std::vector<Point>& points);

}  // namespace liftmesh::dynamic
