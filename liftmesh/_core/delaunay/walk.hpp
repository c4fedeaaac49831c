// The visibility walk: from a triangle across an edge that separates it from the query, again and
// again. In a Delaunay triangulation such a walk never returns to a triangle (Edelsbrunner 1990),
// and with exact orientations it ends at the right one, wherever it begins.
//
// A step is a chain of loads, at the end of which the side is as good as random. So no branch
// depends on the side, both sides are judged side by side, and a caller with many queries takes
// steps of several walks in turn: their loads overlap. Corners are kept relative to the query,
// which is the first thing that an orientation computes; where rounding leaves it open, they are
// read again.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "delaunay/first_containing.hpp"
#include "delaunay/triangulated.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

class Walk {
 public:
    explicit Walk(const Triangulated& mesh) : mesh_(&mesh) {}

    // Starts as if it had come across the first side of a triangle, from whichever side of it the
    // query is not on. On that side, or beyond it where there is no triangle, it is in doubt.
    void begin(Point query, std::int32_t start) {
        query_ = pair(query);
        const Pair tail = mesh_->place(start, 2), head = mesh_->place(start, 1);
        const std::int32_t beyond = mesh_->neighbor(start, 0);
        const int turn = orient2d(point(head), point(tail), query);
        const bool crosses = (turn < 0) & (beyond >= 0);
        from_ = crosses ? start : nowhere;
        at_ = crosses ? beyond : start;
        const Pair ends[2] = {tail - query_, head - query_};
        tail_ = ends[crosses];
        head_ = ends[!crosses];
        is_in_doubt_ = (turn <= 0) & !crosses;
        is_outside_ = false;
    }

    // Before each step: fetches the corner that the triangle adds to the side just crossed.
    void look() {
        k_ = mesh_->place_of_neighbor(at_, from_);
        apex_ = mesh_->vertex(at_, k_);
        mesh_->points.prefetch(static_cast<std::size_t>(apex_));
    }

    // Goes to the next triangle. False if there is none: the walk has ended.
    bool step() {
        const Pair apex = mesh_->place(apex_) - query_;
        const Pair turns = turns_at(apex);
        const PairBits order = Pair{turns[0], turns[0]} < Pair{turns[1], turns[1]};
        const PairBits behind = turns < Pair{0, 0};
        if ((behind[0] | behind[1]) == 0) return false;
        const std::int32_t next =
            mesh_->neighbor(at_, wrapped(k_ + 2 + static_cast<int>(order[0])));
        is_outside_ = next < 0;
        if (is_outside_) return false;
        mesh_->prefetch(next);
        tail_ = order ? tail_ : apex;
        head_ = order ? apex : head_;
        is_in_doubt_ = false;
        from_ = at_;
        at_ = next;
        return true;
    }

    // Where the walk is, and another one can begin.
    std::int32_t at() const { return at_; }

    // Once it has ended: outside the hull, or in a triangle, on the border of which the query may
    // be.
    bool is_outside() const { return is_outside_; }
    bool is_in_doubt() const { return is_in_doubt_; }

    // How many steps of all its walks needed exact arithmetic, which takes several times as long.
    std::size_t exact_steps() const { return exact_steps_; }

 private:
    static constexpr std::int32_t nowhere = -2;  // no neighbour: that is the side opposite corner 0

    static int wrapped(int k) { return k - 3 * (k >= 3); }

    // Positive where the query is on the inner side of tail and apex, and of apex and head: the
    // determinants and the filter of `orient2d`.
    Pair turns_at(Pair apex) {
        const Pair left = Pair{tail_[0], apex[0]} * Pair{apex[1], head_[1]};
        const Pair right = Pair{tail_[1], apex[1]} * Pair{apex[0], head_[0]};
        const Pair turns = left - right;
        const Pair error =
            orient2d_bound * (magnitudes(left) + magnitudes(right)) + orient2d_underflow;
        const PairBits sure = magnitudes(turns) > error;
        if ((sure[0] & sure[1]) != 0) [[likely]]
            return turns;
        return exact_turns();
    }
    Pair exact_turns();

    const Triangulated* mesh_;
    Pair query_;
    Pair tail_, head_;  // the side of the triangle opposite corner k, seen from across it
    std::int32_t at_, from_;
    int k_;              // the corner that from_ has not
    std::int32_t apex_;  // its row
    bool is_in_doubt_;   // whether the query may be on the border of this triangle, or beyond
    bool is_outside_;
    std::size_t exact_steps_ = 0;
};

// The walk straight up or down: from an edge above or below a query through the triangles on the
// vertical line between them, to the one that contains the query.
//
// The line leaves a triangle left or right of the corner that is opposite the edge by which it came
// in, which is a comparison of coordinates, and the query is beyond that edge or not: an exact
// orientation. The line leans infinitesimally to the left: where x is equal, y decides. So it meets
// one corner at most, and then the query is that corner; vertical edges are edges as others are.

// An edge: its left and its right end in the order of x and then y, which is the order of the
// vertical lines through them.
struct Segment {
    Point left, right;

    bool meets_vertical_line_through(Point p) const {
        return !(int{before_xy(p, left)} | int{before_xy(right, p)});
    }
};

// The edge opposite corner k of triangle t is number 3 t + k.
inline constexpr std::uint32_t no_edge = ~std::uint32_t{0};

inline Segment segment(const Triangulated& mesh, std::uint32_t edge) {
    const auto triangle = static_cast<std::int32_t>(edge / 3);
    const int k = static_cast<int>(edge % 3);
    const Point tail = mesh.corner(triangle, (k + 1) % 3);
    const Point head = mesh.corner(triangle, (k + 2) % 3);
    return before_xy(tail, head) ? Segment{tail, head} : Segment{head, tail};
}

class VerticalWalk {
 public:
    explicit VerticalWalk(const Triangulated& mesh) : mesh_(&mesh) {}

    // Starts at an edge that the vertical line through the query meets. False if it ends there.
    bool begin(Point query, std::uint32_t edge);

    // Goes to the next triangle. False if there is none: the walk has ended.
    bool step() {
        const Pair apex = mesh_->place(apex_);
        is_in_doubt_ = point(apex) == query_;
        if (is_in_doubt_) return false;
        // Which of the other two edges the line meets: that of the tail, or that of the head. As it
        // is as good as random, no branch depends on it.
        const bool by_tail = before_xy(query_, point(apex)) == goes_up_;
        const PairBits bits{-static_cast<long long>(by_tail), -static_cast<long long>(by_tail)};
        head_ = bits ? apex : head_;
        tail_ = bits ? tail_ : apex;
        const int turn = orient2d(point(tail_), point(head_), query_);
        is_in_doubt_ = turn == 0;
        const int beyond = k_ + 1 + static_cast<int>(by_tail);
        return turn > 0 && cross(at_, beyond - 3 * (beyond >= 3));
    }

    // After each step: finds the corner opposite the edge by which the line came in. Loads of other
    // walks overlap with what it fetches.
    void look() { look(mesh_->place_of_neighbor(at_, from_)); }

    // Where it has ended: outside, or in a triangle, on the border of which the query may be.
    bool is_outside() const { return is_outside_; }
    bool is_in_doubt() const { return is_in_doubt_; }
    std::int32_t at() const { return at_; }

    // An edge of that triangle where a walk to another query can start; `no_edge` if it has none.
    std::uint32_t start_for(Point query) const;

 private:
    void look(int k) {
        k_ = k;
        apex_ = mesh_->vertex(at_, k);
        mesh_->points.prefetch(static_cast<std::size_t>(apex_));
    }

    bool cross(std::int32_t triangle, int k) {
        const std::int32_t next = mesh_->neighbor(triangle, k);
        is_outside_ = next < 0;
        if (is_outside_) return false;
        mesh_->prefetch(next);
        from_ = triangle;
        at_ = next;
        return true;
    }

    const Triangulated* mesh_;
    Point query_;
    Pair tail_, head_;  // the edge by which the line came in, with the triangle on its left
    std::int32_t at_, from_, apex_;
    int k_;  // the corner opposite that edge
    bool goes_up_, is_outside_, is_in_doubt_;
};

// Vertical walks of many queries. Those of half a trapezoid come from its edge inwards, and each
// walk starts at the triangle where the one before has ended, if the vertical line through the
// query meets it: then only the edges between the two queries are crossed. Several bundles of
// queries take their steps in turn, so that their loads overlap.

// Queries that an edge is above or below.
struct Bundle {
    const Site *first, *last;
    std::uint32_t edge;
};

// Calls settle(query, walk) when a walk has ended. A walk longer than `longest`, which is at first
// the number of triangles, means that the arrays were modified. What is found is meaningless then:
// the walk is dropped, and the next ones end soon.
template <class Settle>
class VerticalWalks {
 public:
    VerticalWalks(const Triangulated& mesh, std::atomic<std::size_t>& longest, Settle settle)
        : lanes_(abreast, Lane{VerticalWalk(mesh)}), longest_(longest), settle_(settle) {}

    void add(const Bundle& bundle) {
        while (busy_ == abreast) advance();
        Lane& lane = lanes_[busy_];
        lane.left = bundle;
        lane.is_first = true;
        if (begins(lane)) ++busy_;
    }

    void finish() {
        while (busy_ > 0) advance();
    }

 private:
    static constexpr std::size_t abreast = 24, soon = 48;

    struct Lane {
        VerticalWalk walk;
        Bundle left{};
        std::size_t steps = 0;
        bool is_first = true;

        std::uint32_t start() {
            const bool is_near = !std::exchange(is_first, false);
            const std::uint32_t near = is_near ? walk.start_for(left.first->point) : no_edge;
            return near != no_edge ? near : left.edge;
        }
    };

    void advance() {
        for (std::size_t i = 0; i < busy_;) {
            if (goes_on(lanes_[i])) {
                ++i;
            } else {
                std::swap(lanes_[i], lanes_[--busy_]);
            }
        }
        for (std::size_t i = 0; i < busy_; ++i)
            if (lanes_[i].steps > 0) lanes_[i].walk.look();
    }

    // A step, or the end of a walk and the begin of the next. False once all of a bundle are done.
    bool goes_on(Lane& lane) {
        if (lane.walk.step()) {
            if (++lane.steps <= longest_) return true;
            longest_ = soon;
        } else {
            settle_(*lane.left.first, lane.walk);
        }
        ++lane.left.first;
        return begins(lane);
    }

    // False if no query is left that takes a step.
    bool begins(Lane& lane) {
        lane.steps = 0;
        for (Bundle& left = lane.left; left.first != left.last; ++left.first) {
            if (lane.walk.begin(left.first->point, lane.start())) return true;
            settle_(*left.first, lane.walk);
        }
        return false;
    }

    std::vector<Lane> lanes_;
    std::size_t busy_ = 0;
    std::atomic<std::size_t>& longest_;
    Settle settle_;
};

}  // namespace liftmesh
