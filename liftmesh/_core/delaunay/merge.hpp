// The merge of two adjacent triangulations along their seam, the core of divide and conquer; and
// what the merge of regular ones (regular_merge.hpp) shares with it.
#pragma once

#include "base/pair.hpp"
#include "base/status.hpp"
#include "delaunay/mesh.hpp"
#include "predicates/incircle.hpp"
#include "predicates/lifted_side.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/seen_from_base.hpp"

namespace liftmesh {

// A finished part, held by two of its ghosts: those of the last merge, at the two ends of its seam,
// where the next merge begins its search.
struct Part {
    TriangleId lower, upper;
    Axis cut;  // across which the last merge was
};

struct Seam {
    Mesh& mesh;
    Guard guard;
    Interrupt& interrupt;
};

// Merges parts that a cut across `axis` separates (all of `left` before all of `right`). It writes
// the triangle slots of both parts, `slot` and the one after it, and nothing else: it may rewrite
// any triangle or ghost of the two parts, and only reads the points. `certainty` holds for all of
// these.
template <class Lift>
Part merge(const Lift& lift, const Seam& seam, const Certainty& certainty, Part left, Part right,
           Axis axis, TriangleId slot);

// The seam of two regular triangulations: the triangles that join them, from the lower to the upper
// common tangent, as found by `walk_seam` (regular_merge.hpp) and put in place by `splice`.

using Side = unsigned;
inline constexpr Side on_left = 0, on_right = 1;

constexpr Side opposite(Side side) {
    return 1 - side;
}

// A triangle of the seam: the end of the base on one side moves on to the apex, along an edge of
// that part.
struct SeamTriangle {
    Vertex apex;
    Side side;
    Edge chain;                 // that edge, in the triangle that stays, if any does
    Edge behind;                // in the triangle that the seam replaces
    std::uint32_t mate = none;  // the triangle across, if it is of the seam as well

    static constexpr std::uint32_t none = ~std::uint32_t{0};
};

// For either side: the ends of the first base and of the last; whether the walk to the first base
// has passed hull vertices, and whether the end has moved along the seam; the ghost at the first
// end that looks at the other side, and the one beyond the gap of the hull at the last end.
struct FoundSeam {
    std::pmr::vector<SeamTriangle> triangles;
    Vertex start[2] = {}, top[2] = {};
    bool has_passed[2] = {}, has_moved[2] = {};
    TriangleId first[2] = {}, last[2] = {};
};

// Dead slots, each with the name of the next at place 0 and `ghost` at the others.
struct FreeList {
    static constexpr TriangleId none = ~TriangleId{0};
    TriangleId first = none, last = none;
    Word count = 0;
};

// Where the walk to a common tangent begins: at the hull vertices next to the cut.

// Along the hull the order has one maximum and one minimum, so climbing from anywhere arrives. It
// is inlined by force: where several merges use it, a compiler makes a function of it, and
// a triangulation would take 5 % longer.
template <class Precedes>
[[gnu::always_inline]] inline TriangleId climb(const Mesh& mesh, TriangleId g, Precedes precedes) {
    Point here = mesh.point(mesh.tail(g));
    const auto moves = [&](TriangleId to) {
        const Point there = mesh.point(mesh.tail(to));
        if (!precedes(here, there)) return false;
        here = there;
        g = to;
        return true;
    };
    while (moves(mesh.successor(g))) continue;
    while (moves(mesh.predecessor(g))) continue;
    return g;
}

// A search begins at an end of the part's own seam: of a seam between parts one above the other,
// the end called lower is the right one.
inline TriangleId ghost_near_last(const Part& part, Axis axis) {
    return axis == Axis::x && part.cut == Axis::y ? part.lower : part.upper;
}
inline TriangleId ghost_near_first(const Part& part, Axis axis) {
    return axis == Axis::x && part.cut == Axis::y ? part.upper : part.lower;
}

// The ghost that leaves the last vertex of a part across the axis.
inline TriangleId leaving_last(const Mesh& mesh, const Part& part, Axis axis) {
    if (axis == Axis::x)
        return climb(mesh, ghost_near_last(part, Axis::x),
                     [](Point p, Point q) { return before(Axis::x, p, q); });
    return climb(mesh, ghost_near_last(part, Axis::y),
                 [](Point p, Point q) { return before(Axis::y, p, q); });
}

// The ghost that leaves the first one.
inline TriangleId leaving_first(const Mesh& mesh, const Part& part, Axis axis) {
    if (axis == Axis::x)
        return climb(mesh, ghost_near_first(part, Axis::x),
                     [](Point p, Point q) { return before(Axis::x, q, p); });
    return climb(mesh, ghost_near_first(part, Axis::y),
                 [](Point p, Point q) { return before(Axis::y, q, p); });
}

// The merge step of divide and conquer (Lee and Schachter 1980, Guibas and Stolfi 1985), on
// the lifted lower hull: the lower tangent is the first edge of the seam; then the plane through
// the base edge turns upward until it touches the next lifted point, left or right, which closes a
// triangle and gives the next base. Edges of either part whose two triangles are no longer lower
// facets are opened on the way: the triangle inside and the ghost outside become two ghosts.
//
// Half of the decisions are as unpredictable as a coin toss. So each side keeps its wall, and what
// is behind it, from step to step: after a misprediction only the side that has moved waits for
// memory.
//
// Where a site is hidden that was not before, this merge gives up: regular_merge.hpp has another.
//
// The names left, right, lower and upper are for a cut across the x axis. A cut across y is the
// same configuration rotated by a right angle, which changes no predicate.

// The decisions that the bound for the whole part leaves open. Arguments are passed by value, so
// that a merge keeps its state in registers.
[[gnu::cold, gnu::noinline]] inline bool is_left_in_doubt(Pair a, Pair b, Pair p) {
    return orient2d(point(a), point(b), point(p)) > 0;
}

template <class Lift, class Value = typename Lift::Value>
[[gnu::cold, gnu::noinline]] bool is_below_in_doubt(const Lift& lift, Pair a, Pair b, Pair c,
                                                    Pair d, Value at_a, Value at_b, Value at_c,
                                                    Value at_d, double value, Guard guard) {
    const Located<Lift> p{a, at_a}, q{b, at_b}, r{c, at_c}, s{d, at_d};
    const double error = SeenFromBase<Lift>(lift, p, q).error_of_below(r, s) + guard.margin();
    if (std::fabs(value) > error) return value > 0;
    if constexpr (hides_sites<Lift>) {
        return lifted_side_canonical_exact<Lift>(lift, p, q, r, s, guard) > 0;
    } else {
        return side_canonical_exact(lift, point(a), point(b), point(c), point(d), guard) > 0;
    }
}

// The ghost of the hull edge that meets the base from above, on one side: it leaves the left end of
// the base, or arrives at its right end. The other end of that edge is the candidate; behind it is
// the third vertex of the triangle inside, which may be a ghost as well.
template <class Lift>
struct Wall {
    TriangleId ghost;
    Vertex candidate, behind;
    Edge inner;  // the edge, in the triangle inside
    Located<Lift> site;
};

template <class Lift, class Hiding>
class OnePassMerge {
 public:
    using Value = typename Lift::Value;

    OnePassMerge(const Lift& lift, const Seam& seam, const Value* values,
                 const Certainty& certainty, TriangleId slot, Hiding& hiding)
        : lift_(lift),
          mesh_(seam.mesh),
          values_(values),
          guard_(seam.guard),
          interrupt_(seam.interrupt),
          certainty_(certainty),
          slot_(slot),
          hiding_(hiding) {}

    // False if a site is hidden that was not before: `hiding` can undo what was done by then.
    [[gnu::always_inline]] bool run(const Part& first, const Part& second, Axis axis) {
        if (!find_lower_tangent(leaving_last(mesh_, first, axis),
                                leaving_first(mesh_, second, axis)))
            return false;
        lay_first_base();
        if constexpr (hides_sites<Lift>) {
            if (!rise_apart()) return false;
        } else {
            rise();
        }
        close();
        return true;
    }

    Part part(Axis axis) const { return {slot_, top(), axis}; }

 private:
    using Base = SeenFromBase<Lift>;
    using Site = Located<Lift>;
    using Place = typename Base::Place;

    Site site(Vertex v) const {
        if constexpr (hides_sites<Lift>) {
            return {mesh_.at(v), values_[v]};
        } else {
            return {mesh_.at(v), {}};
        }
    }
    // The second of the two triangles that the merge adds.
    TriangleId top() const { return slot_ + words_per_triangle; }

    void set_end(Side side, Vertex v, const Site& p) {
        end_[side] = v;
        site_[side] = p;
    }

    [[gnu::always_inline]] bool find_lower_tangent(TriangleId from_left, TriangleId from_right) {
        TriangleId g[2] = {from_left, from_right};
        set_end(on_left, mesh_.tail(g[on_left]), site(mesh_.tail(g[on_left])));
        set_end(on_right, mesh_.tail(g[on_right]), site(mesh_.tail(g[on_right])));
        for (;;) {
            const Vertex v = mesh_.head(g[on_right]);
            if (const Site p = site(v); is_below_base(p, on_right)) {
                set_end(on_right, v, p);
                g[on_right] = mesh_.successor(g[on_right]);
                continue;
            }
            const TriangleId before = mesh_.predecessor(g[on_left]);
            const Vertex w = mesh_.tail(before);
            const Site q = site(w);
            if (!is_below_base(q, on_left)) break;
            set_end(on_left, w, q);
            g[on_left] = before;
        }
        first_[on_left] = g[on_left];
        first_[on_right] = g[on_right];
        return !has_hidden_;
    }

    bool is_below_base(const Site& p, Side side) {
        const Pair across = site_[on_right].at - site_[on_left].at, to = p.at - site_[on_left].at;
        const Pair product = across * swapped(to);
        const double distance = product[0] - product[1];
        if (std::fabs(distance) > certainty_.of_distance) [[likely]]
            return distance < 0;
        if constexpr (hides_sites<Lift>) has_hidden_ |= is_end_hidden_by(p, side);
        return is_left_in_doubt(site_[on_right].at, site_[on_left].at, p.at);
    }

    // On the tangent line, the segment from the next site to the other end may hide an end.
    [[gnu::cold, gnu::noinline]] bool is_end_hidden_by(const Lifted<Lift>& next, Side side) const {
        const Lifted<Lift> end = site_[side], other = site_[opposite(side)];
        return orient2d(next.point, end.point, other.point) == 0 &&
               is_between_and_hidden(lift_, next, end, other);
    }

    // The new ghost has no triangle inside yet; looking there finds itself.
    void lay_first_base() {
        const TriangleId after = first_[on_right];
        first_[on_right] = mesh_.predecessor(after);
        for (Side side : {on_left, on_right}) hiding_.save(mesh_, first_[side]);
        mesh_.place_ghost(slot_, end_[on_left], end_[on_right]);
        mesh_.chain(mesh_.predecessor(first_[on_left]), slot_);
        mesh_.chain(slot_, after);
        base_ = mesh_.hull_edge(slot_);
        mesh_.join(base_, base_);
    }

    // In a ghost at the wall the candidate stands at place `side`, the end of the base at the
    // other.
    Wall<Lift> wall(TriangleId g, Vertex candidate, const Site& p, Edge inner) const {
        const Vertex behind = mesh_.apex(inner);
        return {g, candidate, behind, inner, p};
    }
    template <Side side>
    Wall<Lift> wall(TriangleId g) const {
        const Vertex candidate = mesh_.vertex(g, side);
        return wall(g, candidate, site(candidate), mesh_.twin(g, 2));
    }
    template <Side side>
    Wall<Lift> after(const Wall<Lift>& w) const {
        return wall<side>(mesh_.twin(w.ghost, opposite(side)) - side);
    }

    // Inlined, it keeps its state in registers. With values there would be too much of it.
    [[gnu::noinline]] bool rise_apart() { return rise(); }

    [[gnu::always_inline]] bool rise() {
        Wall<Lift>& l = wall_[on_left];
        Wall<Lift>& r = wall_[on_right];
        l = wall<on_left>(first_[on_left]);
        r = wall<on_right>(first_[on_right]);
        for (Patience patience(interrupt_); !patience.ends();) {
            const Base base(lift_, site_[on_left], site_[on_right]);
            Place c = base.place(l.site), d = base.place(r.site);
            const bool left_is_above = is_above(c, l.site);
            const bool right_is_above = is_above(d, r.site);
            const bool left_is_covered = hiding_.is_covered(on_left, left_is_above);
            const bool right_is_covered = hiding_.is_covered(on_right, right_is_above);
            if (left_is_covered | right_is_covered) [[unlikely]]
                return false;
            if (!left_is_above && !right_is_above) return true;
            if (left_is_above) open<on_left>(base, c);
            if (right_is_above) open<on_right>(base, d);
            if (left_is_above && !(right_is_above && is_below(base, l.site, c, r.site, d))) {
                advance<on_left>();
            } else {
                advance<on_right>();
            }
        }
        return true;
    }

    bool is_above(const Place& place, const Site& p) const {
        if (std::fabs(Base::distance(place)) > certainty_.of_distance) [[likely]]
            return Base::distance(place) > 0;
        return is_left_in_doubt(site_[on_left].at, site_[on_right].at, p.at);
    }

    // Whether the lift of d is below the plane through the base and the lift of c.
    bool is_below(const Base& base, const Site& c, const Place& place_of_c, const Site& d,
                  const Place& place_of_d) const {
        const double value = base.below(place_of_c, place_of_d);
        if (std::fabs(value) > certainty_.of_circle) [[likely]]
            return value > 0;
        const Site &a = site_[on_left], &b = site_[on_right];
        return is_below_in_doubt(lift_, a.at, b.at, c.at, d.at, a.value, b.value, c.value, d.value,
                                 value, guard_);
    }

    // While the next point inward is below the plane of the base and the candidate, the hull edge
    // to the candidate is removed: the two other edges of the triangle behind it get a ghost each.
    template <Side side>
    void open(const Base& base, Place& place) {
        Wall<Lift>& w = wall_[side];
        while (w.behind != ghost) {
            const Site behind = site(w.behind);
            const Place place_behind = base.place(behind);
            if (!is_below(base, w.site, place, behind, place_behind)) return;
            const TriangleId far = triangle_of(w.inner);
            hiding_.save(mesh_, far);
            hiding_.open(side);
            const Edge near_edge = mesh_.twin(side == on_left ? previous(w.inner) : next(w.inner));
            const Edge far_edge = mesh_.twin(side == on_left ? next(w.inner) : previous(w.inner));
            mesh_.vertex(far, side) = w.candidate;
            mesh_.vertex(far, opposite(side)) = w.behind;
            mesh_.vertex(far, 2) = ghost;
            mesh_.join(edge(far, opposite(side)), mesh_.twin(w.ghost, opposite(side)));
            mesh_.join(mesh_.hull_edge(far), far_edge);
            mesh_.vertex(w.ghost, side) = w.behind;
            mesh_.join(edge(w.ghost, opposite(side)), edge(far, side));
            mesh_.join(mesh_.hull_edge(w.ghost), near_edge);
            w = wall(w.ghost, w.behind, behind, near_edge);
            place = place_behind;
        }
    }

    // The ghost at the wall becomes the triangle of the base and the candidate.
    template <Side side>
    void advance() {
        const TriangleId filled = wall_[side].ghost;
        set_end(side, wall_[side].candidate, wall_[side].site);
        wall_[side] = after<side>(wall_[side]);
        hiding_.save(mesh_, wall_[side].ghost);
        hiding_.advance(side);
        mesh_.vertex(filled, 2) = end_[opposite(side)];
        mesh_.join(edge(filled, side), base_);
        base_ = edge(filled, opposite(side));
    }

    void close() {
        mesh_.place_ghost(top(), end_[on_right], end_[on_left]);
        mesh_.chain(wall_[on_right].ghost, top());
        mesh_.chain(top(), wall_[on_left].ghost);
        mesh_.join(mesh_.hull_edge(top()), base_);
    }

    [[no_unique_address]] Lift lift_;
    Mesh mesh_;
    const Value* values_;
    Guard guard_;
    Interrupt& interrupt_;
    Certainty certainty_;
    TriangleId slot_;
    Hiding& hiding_;
    // What each step finds out for the next ones.
    TriangleId first_[2];  // the ghosts of the first walls
    Wall<Lift> wall_[2];
    Vertex end_[2];  // of the base, and where they are
    Site site_[2];
    Edge base_;
    bool has_hidden_ = false;  // an end of a tangent
};

}  // namespace liftmesh
