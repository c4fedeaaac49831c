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

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/pair.hpp"
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

}  // namespace liftmesh
