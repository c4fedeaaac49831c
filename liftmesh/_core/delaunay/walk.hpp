// The visibility walk: from a triangle across an edge that separates it from the query, again and
// again. In a Delaunay triangulation such a walk never returns to a triangle (Edelsbrunner 1990),
// and with exact orientations it ends at the right one, wherever it begins.
//
// A step is a chain of loads, at the end of which the side is as good as random. So no branch
// depends on the side, and a caller with many queries takes steps of several walks in turn: their
// loads overlap.
#pragma once

#include <bit>
#include <cstdint>

#include "delaunay/hubs.hpp"
#include "delaunay/triangulated.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

class Walk {
 public:
    static constexpr std::int32_t outside = -1, unfinished = -2;

    explicit Walk(const Triangulated& mesh) : mesh_(&mesh) {}

    void begin(Point query, std::int32_t start) {
        query_ = query;
        at_ = start;
        from_ = nowhere;
        tail_ = mesh_->corner(start, 2);
        head_ = mesh_->corner(start, 1);
        turn_[0] = orient2d(head_, tail_, query);
        is_outside_ = false;
    }

    // Before each step: fetches the corner that the triangle adds to the side just crossed.
    void look() {
        k_ = mesh_->place_of_neighbor(at_, from_);
        apex_ = static_cast<std::size_t>(mesh_->vertex(at_, k_));
        mesh_->points.prefetch(apex_);
    }

    // Goes to the next triangle. False if there is none: the walk has ended.
    bool step() {
        const Point apex = mesh_->points[apex_];
        turn_[1] = orient2d(tail_, apex, query_);
        turn_[2] = orient2d(apex, head_, query_);
        const unsigned beyond = (turn_[0] < 0) | (turn_[1] < 0) << 1 | (turn_[2] < 0) << 2;
        if (beyond == 0) return false;
        const int over = std::countr_zero(beyond);
        const std::int32_t next = mesh_->neighbor(at_, wrapped(k_ + over));
        is_outside_ = next < 0;
        if (is_outside_) return false;
        mesh_->prefetch(next);
        const double x[3] = {tail_.x, apex.x, head_.x}, y[3] = {tail_.y, apex.y, head_.y};
        const int tail = wrapped(over + 2);
        tail_ = {x[tail], y[tail]};
        head_ = {x[over], y[over]};
        turn_[0] = 1;
        from_ = at_;
        at_ = next;
        return true;
    }

    // Where the walk is, and another one can begin.
    std::int32_t at() const { return at_; }

    // Once it has ended: `outside`, or the first triangle of the arrays whose closure contains the
    // query. It depends on the query alone, also on an edge or at a vertex, where several do.
    // `unfinished` if many meet at the vertex, and no table of hubs is given.
    std::int32_t answer(const Hubs* hubs) const {
        if (is_outside_) return outside;
        return (turn_[0] & turn_[1] & turn_[2]) != 0 ? at_ : least_here(hubs);
    }

 private:
    static constexpr std::int32_t nowhere = -2;  // no neighbour: that is the side opposite corner 0

    static int wrapped(int k) { return k - 3 * (k >= 3); }
    std::int32_t least_here(const Hubs* hubs) const;
    std::int32_t least_around(int k, const Hubs* hubs) const;

    const Triangulated* mesh_;
    Point query_;
    Point tail_, head_;  // the side of the triangle opposite corner k, seen from across it
    std::int32_t at_, from_;
    int k_;             // the corner that from_ has not
    std::size_t apex_;  // its row
    int turn_[3];  // the orientation of the query and the sides opposite corners k, k + 1, k + 2
    bool is_outside_;
};

}  // namespace liftmesh
