#include "cells/fan.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

Point turned_left(Point p) {
    return {-p.y, p.x};
}

}  // namespace

Fan::Fan(const Point* points, std::int32_t row, const std::vector<Spoke>& around,
         LineSegment segment, Guard guard)
    : points_(points), site_(points[row]), around_(around), segment_(segment), guard_(guard) {
    first_ = find_first();
    ahead_ = count_below(Rank::ahead);
    left_ = count_below(Rank::left);
}

Fan::Rank Fan::rank_of(std::int32_t row) const {
    const int along = sign_along(segment_, site_, points_[row], guard_);
    if (along > 0) return Rank::ahead;
    const LineSegment across{turned_left(segment_.from), turned_left(segment_.to)};
    if (sign_along(across, site_, points_[row], guard_) < 0)
        return along < 0 ? Rank::behind_right : Rank::right;
    return along < 0 ? Rank::behind_left : Rank::left;
}

bool Fan::is_before(std::int32_t p, std::int32_t q) const {
    const Rank of_p = rank_of(p), of_q = rank_of(q);
    return of_p != of_q ? of_p < of_q : orient2d(site_, points_[p], points_[q]) > 0;
}

// The list is in order, in a circle: where does it begin anew?
std::size_t Fan::find_first() const {
    std::size_t low = 0, high = around_.size() - 1;
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (is_before(around_[high].row, around_[middle].row))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

std::size_t Fan::count_below(Rank limit) const {
    std::size_t low = 0, high = around_.size();
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (rank(middle) < limit)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

}  // namespace liftmesh
