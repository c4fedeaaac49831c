// The neighbours of a site, all around it, seen from a segment.
//
// Neighbours are listed counter-clockwise. The ridges that a segment may leave the cell over are
// those whose gap falls along it: those of the neighbours ahead, by less than a right angle to
// either side. They are consecutive, so they are found by binary search, and so is the one that the
// segment crosses first: from the last on the right to the last on the left they cross it earlier
// and earlier, then later and later, since their ridges go around a convex cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cells/power_side.hpp"
#include "cells/spokes.hpp"

namespace liftmesh {

class Fan {
 public:
    Fan(const Point* points, std::int32_t row, const std::vector<Spoke>& around,
        LineSegment segment, Guard guard);

    // Neighbours in the order of their directions, from behind on the right to behind on the left:
    // those ahead, and before and after these at most one that is exactly aside.
    std::size_t ahead() const { return ahead_; }
    std::size_t left() const { return left_; }
    bool is_right_aside() const { return ahead_ > 0 && rank(ahead_ - 1) == Rank::right; }
    bool is_left_aside() const { return left_ < around_.size() && rank(left_) == Rank::left; }

    std::size_t count() const { return around_.size(); }
    // `i` may be beyond the ends, in a circle.
    std::int32_t row(std::size_t i) const { return around_[(first_ + i) % around_.size()].row; }

 private:
    enum class Rank : std::uint8_t { behind_right, right, ahead, left, behind_left };

    Rank rank(std::size_t i) const { return rank_of(row(i)); }
    Rank rank_of(std::int32_t row) const;
    bool is_before(std::int32_t p, std::int32_t q) const;
    std::size_t find_first() const;
    std::size_t count_below(Rank rank) const;

    const Point* points_;
    Point site_;
    const std::vector<Spoke>& around_;
    LineSegment segment_;
    Guard guard_;
    std::size_t first_ = 0, ahead_ = 0, left_ = 0;
};

}  // namespace liftmesh
