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
//
// Edges may be constraints (constrained/constrained.hpp): then triangles conflict with no point
// that they see. So a cavity ends at constraints, but for one on which the point lies. A hole is
// filled as without them: the triangles of a star see all its vertices, and conflict with none, if
// no edge at its centre is a constraint; otherwise these are two, on one line, and leave two such
// holes. Edges are marked in `Slots`; `Constraints` tells which they are part of, also of points on
// one line (edges.cpp).
#pragma once

#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/delaunay.hpp"
#include "dynamic/constraints.hpp"
#include "dynamic/hints.hpp"
#include "dynamic/patch.hpp"
#include "dynamic/slots.hpp"
#include "predicates/incircle.hpp"
#include "predicates/scale.hpp"

namespace liftmesh::dynamic {

struct Lexicographic {
    bool operator()(Point a, Point b) const { return before_xy(a, b); }
};

// Points on one line, in order.
using Line = std::map<Point, Vertex, Lexicographic>;

// Between two of them.
std::vector<Piece> pieces_between(const Line& line, Point a, Point b);

// Where a point is: at a vertex, or in conflict with a triangle.
struct Place {
    Vertex vertex = ghost;
    TriangleId triangle = nothing;
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

    // Puts in a constraint; or returns those that it would cross, in order, and changes nothing.
    std::vector<Piece> insert_constraint(Vertex a, Vertex b);
    // One that is there.
    void remove_constraint(Vertex a, Vertex b);
    const Constraints& constraints() const { return constraints_; }
    // The constraints without which a vertex can be removed: those that end there, or that would
    // cross; in order.
    std::vector<Piece> holders(Vertex v) const;

    // Many at once: in an order of neighbourhood, or all anew where they are many. If interrupted,
    // some of them are in, or out, and the triangulation is that of the points present.
    Status insert(const Input& input, Vertex* found, Interrupt& interrupt);
    Status remove(const Vertex* vertices, std::size_t count, Interrupt& interrupt);

    // The vertex at a position, or `ghost`.
    Vertex find(Point p, Vertex hint = ghost) const;

    // For callers that keep constraints by themselves: takes over triangles with marks, of rows
    // that it returns as vertices.
    std::vector<Row> adopt(const Input& input, Constrained& mesh);
    void mark(Edge e) { slots_.mark(e); }
    void unmark(Edge e) { slots_.unmark(e); }
    // An edge from a vertex, and the next one counter-clockwise.
    Edge edge_from(Vertex v) const { return previous(corner_[v]); }
    Edge turned(Edge e) const { return slots_.twin(previous(e)); }
    // From a vertex to a neighbour, or `nothing`.
    Edge edge_between(Vertex from, Vertex to) const;

    // Triangles over the numbers of vertices, and the hull.
    Result result() const;
    // The marks of the same triangles.
    std::vector<constrained::Mark> marks() const;
    // Room for so many further points.
    void reserve(std::size_t count);

    // Brings what an insertion into a triangle will read: the triangle itself, or, once that is
    // there, its corners and neighbours.
    [[gnu::always_inline]] void prefetch(TriangleId t) const { slots_.prefetch(t); }
    void prefetch_around(TriangleId t) const;

    // The parts of an insertion, for callers that keep something by triangles: the place of a new
    // point, the cavity of triangles that conflict with it, and its star in their stead.
    Place locate(Point p, Vertex hint) const;
    void dig(Point p, TriangleId conflict, Edge split = nothing);  // which is crossed
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
    void make_hints();
    void connect_star(Vertex v);
    Edge constraint_at(Point p, TriangleId t) const;
    Vertex fill(Point p, Edge split);
    Vertex insert_on_line(Point p);
    bool is_off_line(Line::const_iterator place) const;
    std::pair<Vertex, Vertex> around(Line::const_iterator place) const;
    void raise(Vertex apex);
    void place_ghosts();
    void remove_from_line(Vertex v);
    bool leaves_a_line(const Star& star) const;
    void put(const std::vector<TriangleId>& gone, const Patch& patch,
             std::vector<TriangleId>& made);
    std::vector<std::size_t> marked_spokes(const Star& star, Vertex v) const;
    void plan_along(const Star& star, std::size_t from, std::size_t to, Patch& patch) const;
    constrained::Insertion insertion();
    void release(Piece piece, constrained::Insertion& insertion);
    void lower(const Star& star);
    Status insert_anew(const Input& input, Vertex* found, Interrupt& interrupt);
    Status remove_anew(const Vertex* vertices, std::size_t count, Interrupt& interrupt);
    std::vector<bool> present() const;
    void gather(const std::vector<bool>& wanted, std::vector<Point>& points,
                std::vector<Vertex>& vertex_of_row) const;
    Constrained build(const std::vector<Point>& points, const std::vector<Vertex>& vertex_of_row,
                      Interrupt& interrupt);
    void take(const Constrained& outcome, const std::vector<Vertex>& vertex_of_row);

    std::vector<Point> points_;
    std::vector<Edge> corner_;  // an edge opposite the vertex
    // Those that are present, in any order, and those that are free, the last one first; and where
    // each is among them.
    std::vector<Vertex> order_, place_;
    std::size_t size_ = 0;  // of those that are present
    Vertex last_ = ghost;
    Hints hints_;
    Range range_;
    Guard guard_ = Guard::in_window();
    Constraints constraints_;
    Slots slots_, fresh_;
    Line line_, fresh_line_;  // all points, while there is no triangle
    Constraints::Parts fresh_parts_;

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
