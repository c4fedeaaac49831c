// Triangles of which regions were removed have no convex boundary, and it may have several closed
// curves. As in verify.cpp, the number of triangles that cover a point changes only where the point
// crosses the boundary; so no two overlap if it is 0 or 1 everywhere.
//
// A line sweeps the plane, by x, then y, and holds the edges of the boundary that it crosses in
// their order (Shamos and Hoey, 1976). Crossed upwards, an edge from left to right begins ground
// that is covered, and one from right to left ends it: so these must alternate. No two edges may
// cross, and none may pass through a vertex of another. Crossing edges are neighbours before they
// cross; whatever become neighbours are tested, and the first pair that cross ends the sweep.
// Constraints may cross in a row, which is no vertex.
//
// - Rows without a vertex must lie where nothing is covered.
// - A constraint, or a part of one, that no edge continues at a vertex must go on where nothing is
//   covered. It is in the line like an edge, and at each row that it passes through it is followed
//   again. Of those in one direction from one row the longest stands for all.
// - Every edge of the boundary must run along a constraint or on the convex hull of the rows. The
//   corners of the hull are on the boundary, or outside.
//
// Then triangles whose unconstrained edges are locally Delaunay are those of the constrained
// Delaunay triangulation where they are (Lee and Lin, 1986), up to ties. Which regions were to be
// removed is not asked.

#include <set>

#include "base/input.hpp"
#include "parallel/blocks.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/patient_sort.hpp"
#include "verify/constraints.hpp"

namespace liftmesh {

namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};

// What the line crosses, from its lesser to its greater end: edge number `id` of the boundary, or
// that constraint.
struct Crossed {
    enum class Kind : std::uint8_t { begins, ends, constraint };  // covered ground, above it

    Row left, right;
    std::uint32_t id;
    Kind kind;
    bool is_edge() const { return kind != Kind::constraint; }
};

// The order upwards along the line.
struct Below {
    using is_transparent = void;
    const Point* points;

    int turn(const Crossed& s, Point p) const {
        return orient2d(points[s.left], points[s.right], p);
    }
    bool operator()(const Crossed& s, Point p) const { return turn(s, p) > 0; }
    bool operator()(Point p, const Crossed& s) const { return turn(s, p) < 0; }
    bool operator()(const Crossed& s, const Crossed& t) const {
        if (before_xy(points[t.left], points[s.left])) {
            const int side = turn(t, points[s.left]);
            return (side == 0 ? turn(t, points[s.right]) : side) < 0;
        }
        const int side = turn(s, points[t.left]);
        return (side == 0 ? turn(s, points[t.right]) : side) > 0;
    }
};

class Sweep {
 public:
    Sweep(const NamedMesh& named, const std::vector<FollowedEdge>& segments,
          ConstrainedEdges& edges, Flaws& flaws)
        : named_(named),
          points_(named.mesh.points),
          segments_(segments),
          edges_(edges),
          flaws_(flaws),
          roles_(named.mesh.rows),
          line_(Below{points_}),
          next_(segments.size()) {}

    bool run(std::optional<std::size_t>& outside) {
        if (!find_events()) return false;
        const auto visit = [&](std::size_t i) {
            if (!overlaps_) visit_row(events_[i]);
        };
        if (!for_each_in_blocks(events_.size(), named_.pool.interrupt(), visit)) return false;
        if (overlaps_) return true;
        check_edges();
        outside = count_outside();
        return true;
    }

 private:
    using Line = std::set<Crossed, Below>;
    static constexpr std::uint8_t event = 1, on_boundary = 2, missing = 4;

    bool is_corner(Row row) const { return named_.corners[row] != 0; }
    bool is_before(Row a, Row b) const { return before_xy(points_[a], points_[b]); }
    int turn(Row a, Row b, Row c) const { return orient2d(points_[a], points_[b], points_[c]); }

    // The line stops at vertices of the boundary, at rows without a vertex, and where constraints
    // that no edges continue end.
    bool find_events() {
        for (const HalfEdge& edge : named_.boundary)
            roles_[edge.tail] = roles_[edge.head] = event | on_boundary;
        for (std::size_t row = 0; row < roles_.size(); ++row)
            if (is_other(row)) roles_[named_.lowest[row]] |= event;
        for (const FollowedEdge& each : segments_)
            if (!each.is_whole()) roles_[each.to] |= event;
        for (Row row = 0; row < roles_.size(); ++row)
            if (roles_[row] & event) events_.push_back(row);
        Interrupt& interrupt = named_.pool.interrupt();
        const auto by_place = [&](Row a, Row b) { return is_before(a, b); };
        if (!patient_sort(events_, by_place, interrupt)) return false;
        for (std::uint32_t i = 0; i < named_.boundary.size(); ++i) {
            const auto [tail, head, place] = named_.boundary[i];
            starting_.push_back(is_before(tail, head)
                                    ? Crossed{tail, head, i, Crossed::Kind::begins}
                                    : Crossed{head, tail, i, Crossed::Kind::ends});
        }
        const auto by_start = [&](const Crossed& s, const Crossed& t) {
            return s.left == t.left ? turn(s.left, s.right, t.right) > 0
                                    : is_before(s.left, t.left);
        };
        if (!patient_sort(starting_, by_start, interrupt)) return false;
        waiting_.assign(roles_.size(), none);
        for (std::uint32_t i = 0; i < segments_.size(); ++i)
            if (!segments_[i].is_whole()) wait(i, segments_[i].reached);
        return true;
    }

    // Whether it is finite, and has no vertex.
    bool is_other(std::size_t row) const {
        return !is_corner(named_.lowest[row]) && is_finite(points_[row]);
    }

    // No edge continues a constraint at a vertex: it is missing there if all around is covered.
    void wait(std::uint32_t constraint, Row at) {
        if (is_corner(at) && !(roles_[at] & on_boundary)) return miss(constraint, at);
        next_[constraint] = std::exchange(waiting_[at], constraint);
    }

    void miss(std::uint32_t constraint, Row at) {
        flaws_.add(Flaw::missing_constraints, {constraint, at});
    }

    void overlap(const Crossed& s, const Crossed& t) {
        overlaps_ = true;
        if (!s.is_edge() || !t.is_edge()) {
            const bool first = !s.is_edge() && (t.is_edge() || s.id < t.id);
            return first ? miss(s.id, s.left) : miss(t.id, t.left);
        }
        const auto [low, high] = std::minmax({place_of(s), place_of(t)});
        flaws_.add(Flaw::overlaps, {low, high});
    }

    std::size_t place_of(const Crossed& s) const {
        return named_.mesh.callers_place(named_.boundary[s.id].place);
    }

    void visit_row(Row row) {
        std::vector<std::uint32_t> constraints;
        Line::iterator above;
        if (!end_at(row, constraints, above)) return;
        const bool covered = is_covered(above);
        if (covered && !is_corner(row)) roles_[row] |= missing;
        for (std::uint32_t i = waiting_[row]; i != none; i = next_[i]) constraints.push_back(i);
        std::vector<Crossed> starting = edges_from(row);
        add_constraints(row, constraints, starting);
        start(starting, above, covered);
    }

    // Removes what ends here, and the constraints that pass through the row. False if an edge
    // passes through it.
    bool end_at(Row row, std::vector<std::uint32_t>& constraints, Line::iterator& above) {
        std::optional<Crossed> through, ending;
        auto [each, last] = line_.equal_range(points_[row]);
        while (each != last) {
            const bool passes = each->right != row;
            if (each->is_edge()) {
                (passes ? through : ending) = *each;
            } else if (passes) {
                constraints.push_back(each->id);
            }
            each = passes && each->is_edge() ? std::next(each) : line_.erase(each);
        }
        above = last;
        if (!through) return true;
        if (!is_corner(row)) roles_[row] |= missing;
        if (roles_[row] & on_boundary) overlap(*through, ending.value_or(starting_[started_]));
        return false;
    }

    // Whether the ground below what is above a row is covered.
    bool is_covered(Line::iterator above) const {
        return above != line_.begin() && std::prev(above)->kind == Crossed::Kind::begins;
    }

    std::vector<Crossed> edges_from(Row row) {
        std::vector<Crossed> edges;
        for (; started_ < starting_.size() && starting_[started_].left == row; ++started_)
            edges.push_back(starting_[started_]);
        return edges;
    }

    // Follows each constraint from the row, but those that another one covers.
    void add_constraints(Row row, std::vector<std::uint32_t>& constraints,
                         std::vector<Crossed>& starting) {
        const auto end = [&](std::uint32_t i) { return segments_[i].to; };
        std::sort(constraints.begin(), constraints.end(), [&](auto i, auto j) {
            const int side = turn(row, end(i), end(j));
            return side != 0 ? side > 0 : end(i) != end(j) ? is_before(end(j), end(i)) : i < j;
        });
        const auto last = std::unique(constraints.begin(), constraints.end(), [&](auto i, auto j) {
            return turn(row, end(i), end(j)) == 0;
        });
        for (auto at = constraints.begin(); at != last; ++at) {
            const Row to = end(*at), reached = is_corner(row) ? edges_.follow(row, to) : row;
            if (reached == row)
                starting.push_back({row, to, *at, Crossed::Kind::constraint});
            else if (reached != to)
                wait(*at, reached);
        }
        std::sort(starting.begin(), starting.end(), [&](const Crossed& s, const Crossed& t) {
            return turn(row, s.right, t.right) > 0;
        });
    }

    // Puts what starts at a row into the line, from below to above.
    void start(const std::vector<Crossed>& starting, Line::iterator above, bool covered) {
        Line::iterator lowest = above;
        for (const Crossed& each : starting) {
            if (!each.is_edge() && covered) {
                miss(each.id, each.left);
                continue;
            }
            const bool begins = each.kind == Crossed::Kind::begins;
            if (each.is_edge() && begins == covered)
                return overlap(each, covered ? *std::prev(above) : each);
            const auto here = line_.emplace_hint(above, each);
            if (here->id != each.id) return overlap(each, *here);
            if (lowest == above) lowest = here;
            covered = each.is_edge() ? begins : covered;
        }
        test_neighbors(lowest);
        if (!overlaps_ && lowest != above) test_neighbors(above);
    }

    void test_neighbors(Line::iterator above) {
        if (above == line_.begin() || above == line_.end()) return;
        const Crossed &low = *std::prev(above), &high = *above;
        const bool may_meet = !low.is_edge() && !high.is_edge();
        if (cross(low, high) && !(may_meet && meet_in_row(low, high))) overlap(low, high);
    }

    // Whether there is a row where two constraints cross: then both are cut there. Rounding mostly
    // tells which it is; otherwise all are tried.
    bool meet_in_row(const Crossed& s, const Crossed& t) const {
        const auto meet_at = [&](Row row) {
            return turn(s.left, s.right, row) == 0 && turn(t.left, t.right, row) == 0;
        };
        const Point a = points_[s.left], b = points_[s.right];
        const Point c = points_[t.left], d = points_[t.right];
        const double ux = b.x - a.x, uy = b.y - a.y, vx = d.x - c.x, vy = d.y - c.y;
        const double along = ((c.x - a.x) * vy - (c.y - a.y) * vx) / (ux * vy - uy * vx);
        const Point place{a.x + along * ux, a.y + along * uy};
        const auto near =
            std::lower_bound(events_.begin(), events_.end(), place,
                             [&](Row row, Point p) { return before_xy(points_[row], p); });
        return (near != events_.end() && meet_at(*near)) ||
               std::any_of(events_.begin(), events_.end(), meet_at);
    }

    // Whether the lower one of two will be above the other where the first of them ends.
    bool cross(const Crossed& low, const Crossed& high) const {
        if (low.right == high.right) return false;
        return is_before(low.right, high.right) ? turn(high.left, high.right, low.right) > 0
                                                : turn(low.left, low.right, high.right) < 0;
    }

    void check_edges() {
        std::vector<Row> lower, upper;
        for (const Crossed& edge : starting_) {
            if (edges_.contain(named_.boundary[edge.id].place)) continue;
            if (lower.empty()) {
                lower = chain(1);
                upper = chain(-1);
            }
            if (!is_along(edge.kind == Crossed::Kind::begins ? lower : upper, edge))
                flaws_.add(Flaw::open_boundaries, {place_of(edge), 0});
        }
    }

    // The corners of the hull, on one side of it (Andrew, 1979).
    std::vector<Row> chain(int side) const {
        std::vector<Row> chain;
        for (const Row row : events_) {
            const auto is_passed = [&] {
                const std::size_t top = chain.size();
                return top > 1 && side * turn(chain[top - 2], chain[top - 1], row) <= 0;
            };
            while (is_passed()) chain.pop_back();
            chain.push_back(row);
        }
        return chain;
    }

    bool is_along(const std::vector<Row>& chain, const Crossed& edge) const {
        const auto after = std::upper_bound(chain.begin(), chain.end(), edge.left,
                                            [&](Row a, Row b) { return is_before(a, b); });
        return after != chain.end() && turn(*std::prev(after), *after, edge.left) == 0 &&
               turn(*std::prev(after), *after, edge.right) == 0;
    }

    std::size_t count_outside() {
        std::size_t outside = 0;
        for (std::size_t row = 0; row < roles_.size(); ++row) {
            if (!is_other(row)) continue;
            if (roles_[named_.lowest[row]] & missing)
                flaws_.add(Flaw::missing_vertices, {row, 0});
            else
                ++outside;
        }
        return outside;
    }

    const NamedMesh& named_;
    const Point* points_;
    const std::vector<FollowedEdge>& segments_;
    ConstrainedEdges& edges_;
    Flaws& flaws_;
    std::vector<std::uint8_t> roles_;  // of each row
    std::vector<Row> events_;          // by x, then y
    std::vector<Crossed> starting_;    // edges of the boundary, by their lesser ends and direction
    std::size_t started_ = 0;
    Line line_;
    std::vector<std::uint32_t> waiting_;  // at each row: a constraint to be followed from there
    std::vector<std::uint32_t> next_;     // of each constraint: another one at that row
    bool overlaps_ = false;
};

}  // namespace

bool check_carving(const NamedMesh& named, const std::vector<FollowedEdge>& segments,
                   ConstrainedEdges& edges, Flaws& flaws, std::optional<std::size_t>& outside) {
    return Sweep(named, segments, edges, flaws).run(outside);
}

}  // namespace liftmesh
