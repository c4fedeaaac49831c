// A refinement under way: triangles that wait, and parts of constraints.
#pragma once

#include <unordered_set>

#include "predicates/orient2d.hpp"
#include "refinement/measures.hpp"
#include "refinement/queues.hpp"
#include "refinement/refine.hpp"

namespace liftmesh::refinement {

using dynamic::BorderEdge;
using dynamic::nothing;

inline constexpr std::int32_t outside = -1;  // in place of a region
inline constexpr std::int32_t given = -2;    // in place of the piece that a vertex divides

// The square of its cosine: pieces that meet in less need no further split across their angle.
inline constexpr double of_sixty_degrees2 = 0.25;

inline constexpr double least_ulps = 64;  // of a base, of which off-centres leave a fiftieth

// A triangle over its shortest side.
struct Shape {
    Edge base;
    double base2, longest2, twice_area;
    double height;  // of the centre of its circle over the base, in lengths of the base
    bool is_sharp;
};

class Refinement {
 public:
    Refinement(const Start& start, const Wanted& wanted, Interrupt& interrupt);

    Status run();
    Status smooth();
    Refined result();  // ends the refinement

 private:
    struct Place {
        TriangleId triangle;
        Edge blocked = nothing;  // the constraint that is in the way
        bool is_vertex = false;
    };

    const dynamic::Slots& slots() const { return mesh_.slots(); }
    Point at(Vertex v) const { return mesh_.point(v); }
    std::int32_t& region(TriangleId t) { return region_[slot_of(t)]; }
    bool is_inside(TriangleId t) const { return region_[slot_of(t)] != outside; }
    // Whether constraints are to be split for its corners.
    bool counts(TriangleId t) const {
        return is_inside(t) || (wanted_.is_conforming && !slots().is_ghost(t));
    }
    // By position; the ghost is last.
    bool is_before(Vertex a, Vertex b) const {
        return a != ghost && (b == ghost || before_xy(at(a), at(b)));
    }
    Vector between(Vertex a, Vertex b) const { return measures_.between(at(a), at(b)); }

    void begin(const Start& start);
    void in_order(std::vector<TriangleId>& triangles) const;
    void look_at_all();
    void expect(double area, double largest);
    void tell(std::size_t stage, std::size_t done, std::size_t all);
    bool does_step();
    void prefetch() const;

    Vector side_of(Edge e) const { return between(slots().tail(e), slots().head(e)); }
    Edge shortest(TriangleId t, const std::array<double, 3>& length2) const;
    Shape shape(TriangleId t) const;
    std::optional<Waiting> need(TriangleId t);
    void look_at(TriangleId t);
    void push(std::vector<Waiting> all);
    std::vector<Waiting> too_long(bool at_end = false);
    bool has_large_area(TriangleId t, const Shape& its);
    std::pair<std::array<Vector, 3>, int> sides_near_one(Edge first) const;
    Edge surely_shortest(TriangleId t) const;
    bool is_listed_for_area(Edge base);
    bool is_listed_for_length(Edge base, double length) const;
    bool is_between_constraints(Edge base) const;
    bool is_blamed(Edge base) const;
    // Of sharp triangles, whether this one is not split for its angle.
    bool is_left(Edge base) const { return is_between_constraints(base) || is_tiny(base); }
    bool is_tiny(Point a, Point b, double ulps = least_ulps) const;
    bool is_tiny(Edge e, double ulps = least_ulps) const {
        return is_tiny(at(slots().tail(e)), at(slots().head(e)), ulps);
    }
    // Whether the apex is that near to an end: farther than a row on the edge beside it.
    bool has_tiny_side(Edge e) const {
        return is_tiny(next(e), 2 * least_ulps) || is_tiny(previous(e), 2 * least_ulps);
    }
    std::int32_t piece_at(Vertex a, Vertex b) const;

    // Those that give way are not counted, up to four for each row that may be there: so it ends.
    bool may_add() const { return made_ - removed_ < wanted_.most && made_ / 4 < wanted_.most; }
    void treat(const Waiting& waiting);
    bool is_gone(const Waiting& waiting) const;
    bool split_long_side(Edge base);
    Point center(const Shape& shape) const;
    Point center(const Shape& shape, double height) const;
    Place walk(Edge base, Point p) const;
    bool is_right_of(Edge e, Point p) const {
        return orient2d(at(slots().tail(e)), at(slots().head(e)), p) < 0;
    }
    bool is_marked_at(Edge e, Point p) const;
    void add(Point p);
    void put(Point p);
    void take_out(Vertex v);
    Vertex fill(Point p, std::int32_t piece);
    void stamp(const std::vector<TriangleId>& triangles);

    bool is_encroached(Edge e, Point p) const;
    bool is_encroached_by_apex(Edge e) const {
        return is_encroached(e, at(slots().apex(e))) && !has_tiny_side(e);
    }
    void look_at_side(Edge e);
    bool ask_to_split(Edge e);
    void split(const Part& part);
    void clear_circle(const Part& part);
    bool remove_apex(Edge e);
    bool is_narrow(Edge e, Edge beside) const;
    bool has_narrow_corner(Edge e) const;
    Point place(const Part& part, Edge e) const;
    Point on_piece(std::int32_t piece, Point p) const;
    std::optional<Point> place_across(const Part& part, Edge side) const;
    std::pair<Vertex, Vertex> ends_from(const Part& part, Vertex corner) const;
    std::vector<std::int32_t> pieces_of(Vertex v) const;
    Vertex vertex_of(Row row) const {
        return static_cast<Vertex>(std::lower_bound(rows_.begin(), rows_.end(), row) -
                                   rows_.begin());
    }
    Vertex corner_of(std::int32_t piece, std::int32_t another) const;
    bool fits(const Part& part, Point p) const;
    bool is_dug(Edge e) const;
    TriangleId find_beside(Edge e, Point p) const;
    bool dig_across(const Part& part, Edge e, Point p);
    void insert_on(const Part& part, Edge e, Point middle);
    void divide(const Part& part, std::int32_t left, std::int32_t right);
    void look_around();
    bool conforms();
    bool is_delaunay_across(Edge e) const;

    bool move(Vertex v);
    TriangleId fresh_around(Point p) const;
    void find_star(Vertex v);
    Point better_place(Vertex v) const;
    double sharpest(const std::vector<TriangleId>& triangles) const;
    bool is_fine(TriangleId t);
    bool is_better(Point p, TriangleId conflict, double before);

    Row row(Vertex v) const { return v < rows_.size() ? rows_[v] : name_[v - rows_.size()]; }
    static std::uint64_t key(const Part& part) {
        return std::uint64_t{part.first} << 32 | part.second;
    }

    const Wanted& wanted_;
    Interrupt& interrupt_;
    Patience patience_;
    std::size_t told_ = 0;
    Measures measures_;
    double sharp_, wide_, off_center_;
    std::vector<double> largest_;
    std::size_t given_rows_;
    std::span<const constrained::Piece> pieces_;

    dynamic::Triangulation mesh_;
    std::vector<Row> rows_;             // of the first vertices
    std::vector<std::int32_t> region_;  // of slots
    std::vector<std::uint32_t> stamp_;  // of slots: when they were filled
    std::uint32_t time_ = 0;
    std::vector<std::int32_t> divided_;  // by vertices
    std::size_t made_ = 0, removed_ = 0;
    double expected_ = 0;  // points, at the end
    bool is_capped_ = false;
    Buckets waiting_;
    Parts parts_;
    std::vector<Waiting> unmeasured_;
    std::unordered_set<std::uint64_t> stuck_;  // parts that cannot be split

    std::vector<Edge> in_the_way_;
    dynamic::Star star_;
    dynamic::Patch patch_;
    std::vector<TriangleId> fresh_;
    std::vector<Row> name_;  // of the vertices that were added
};

}  // namespace liftmesh::refinement
