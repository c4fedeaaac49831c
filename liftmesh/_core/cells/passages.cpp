#include "cells/clip.hpp"
#include "cells/diagram.hpp"
#include "cells/power_centre.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

// The neighbours of a site, all around it, seen from a segment.
//
// Neighbours are listed counter-clockwise. The ridges that a segment may leave the cell over are
// those whose gap falls along it: those of the neighbours ahead, by less than a right angle to
// either side. They are consecutive, so they are found by binary search, and so is the one that the
// segment crosses first: from the last on the right to the last on the left they cross it earlier
// and earlier, then later and later, since their ridges go around a convex cell.

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

Point turned_left(Point p) {
    return {-p.y, p.x};
}

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

// From so many neighbours on, a cell is a hub: they are listed once, and searched instead of asked
// one by one, or time would be in proportion to them times the edges of the domain.
constexpr std::size_t many = 48;

struct Hub {
    std::vector<Spoke> around;
    bool has_point = false;
    Point point = {};  // in the cell
};

template <class Lift>
class Following {
 public:
    Following(const Dual& dual, const Spokes& spokes, const Domain& domain, Interrupt& interrupt,
              std::vector<Passage>& found, std::vector<Tie>& ties)
        : dual_(dual),
          spokes_(spokes),
          domain_(domain),
          patience_(interrupt),
          found_(found),
          ties_(ties) {
        guard_ = is_small() ? Guard::in_window() : Guard::anywhere();
    }

    Clipping run() {
        cell_ = spokes_.any();
        Clipping outcome = Clipping::done;
        for (std::size_t ring = 0; ring < domain_.rings && cell_ >= 0; ++ring)
            if (outcome == Clipping::done) outcome = follow(static_cast<std::int32_t>(ring));
        return outcome;
    }

 private:
    static constexpr bool is_plain = std::is_same_v<Lift, Paraboloid>;

    Lifted<Lift> site(std::int32_t row) const {
        if constexpr (is_plain)
            return {dual_.points[row], {}};
        else
            return {dual_.points[row], dual_.values[row]};
    }

    // Whether the filters hold for all sites that have a cell, and for the domain.
    bool is_small() const {
        for (std::size_t row = 0; row < dual_.rows; ++row)
            if (spokes_.has(static_cast<std::int32_t>(row)) &&
                !is_in_window(site(static_cast<std::int32_t>(row))))
                return false;
        for (std::int32_t i = 0; i < domain_.starts[domain_.rings]; ++i)
            if (!is_in_window(Lifted<Paraboloid>{domain_.corners[i], {}})) return false;
        return true;
    }

    int gap(Point p, std::int32_t row) const {
        return gap_sign(Lift{}, p, site(cell_), site(row), guard_);
    }
    bool is_nearer(Point p, std::int32_t s, std::int32_t t) const {
        return liftmesh::is_nearer(Lift{}, p, site(s), site(t), guard_);
    }

    // Moves to the cell of a point, from neighbour to neighbour that is nearer.
    bool locate(Point p) {
        for (bool moved = true; moved;) {
            const Hub* const hub = enter(cell_);
            const std::int32_t row = hub != nullptr && hub->has_point
                                         ? way_out({hub->point, p}, hub->around)
                                         : nearer(p, hub != nullptr ? hub->around : around_);
            moved = row >= 0;
            if (moved) cell_ = row;
            if (patience_.ends(around_.size() + 1)) return false;
        }
        if (const auto hub = hubs_.find(cell_); hub != hubs_.end()) {
            hub->second.has_point = true;
            hub->second.point = p;
        }
        return true;
    }

    // Lists the neighbours of a cell, unless it is a hub that is known.
    const Hub* enter(std::int32_t row) {
        if (const auto known = hubs_.find(row); known != hubs_.end()) return &known->second;
        if (listed_ != row) spokes_.list(row, around_);
        listed_ = row;
        if (around_.size() < many) return nullptr;
        listed_ = -1;
        // Without values, a site is in its own cell.
        return &(hubs_[row] = {std::move(around_), is_plain, dual_.points[row]});
    }

    std::int32_t nearer(Point p, const std::vector<Spoke>& around) const {
        for (const Spoke& spoke : around)
            if (!is_nearer(p, cell_, spoke.row)) return spoke.row;
        return -1;
    }

    Clipping follow(std::int32_t ring) {
        const std::int32_t start = domain_.starts[ring], end = domain_.starts[ring + 1];
        if (!locate(domain_.corners[start])) return Clipping::interrupted;
        const std::size_t first = found_.size();
        Passage here{cell_, ring, start, 1, {}, {}};
        for (std::int32_t corner = start; corner < end; ++corner) {
            const std::int32_t next = corner + 1 < end ? corner + 1 : start;
            if (!follow_edge(corner, next, here)) return Clipping::interrupted;
            if (next != start && ++here.count == 1) here.first = next;
        }
        if (found_.size() == first)
            found_.push_back(here);
        else if (here.cell == found_[first].cell)
            join(here, found_[first]);
        else
            return Clipping::not_simple;
        return Clipping::done;
    }

    bool follow_edge(std::int32_t edge, std::int32_t next, Passage& here) {
        const LineSegment segment{domain_.corners[edge], domain_.corners[next]};
        for (;;) {
            const Hub* const hub = enter(cell_);
            if (patience_.ends(around_.size() + 1)) return false;
            const std::int32_t row =
                hub != nullptr ? entered_from(*hub, segment) : entered(segment);
            note_ties(segment, edge, row < 0 ? next : -1);
            if (row < 0) return true;
            const Estimate at = crossing(Lift{}, segment, site(cell_), site(row), guard_);
            here.out = {edge, row, point(at.centre.high), is_certain(at)};
            found_.push_back(here);
            here = {row, here.ring, next, 0, {edge, cell_, here.out.at, here.out.is_certain}, {}};
            cell_ = row;
        }
    }

    // The row whose cell a segment enters from this one; -1 if it ends here.
    std::int32_t entered(LineSegment segment) {
        std::int32_t best = -1;
        tied_.clear();
        for (const Spoke& spoke : around_) {
            const int side = gap(segment.to, spoke.row);
            if (side == 0) tied_.push_back(spoke.row);
            if (side > 0 || (side == 0 && is_nearer(segment.to, cell_, spoke.row))) continue;
            if (best < 0 ||
                enters_before(Lift{}, segment, site(cell_), site(spoke.row), site(best), guard_))
                best = spoke.row;
        }
        return best;
    }

    // The same for a cell with many neighbours.
    std::int32_t entered_from(const Hub& hub, LineSegment segment) {
        tied_.clear();
        const Fan fan(dual_.points, cell_, hub.around, segment, guard_);
        if (fan.is_right_aside()) collect_ties(fan, fan.ahead() - 1, segment.to);
        if (fan.is_left_aside()) collect_ties(fan, fan.left(), segment.to);
        const std::size_t best = first_crossed(fan, segment);
        if (best < fan.left() && !is_nearer(segment.to, cell_, fan.row(best))) return fan.row(best);
        // It ends here: on the ridges of neighbours side by side, if on any.
        if (best < fan.left()) collect_ties(fan, best, segment.to);
        const LineSegment back{segment.to, segment.from};
        const Fan behind(dual_.points, cell_, hub.around, back, guard_);
        if (const std::size_t last = first_crossed(behind, back); last < behind.left())
            collect_ties(behind, last, segment.to);
        return -1;
    }

    std::int32_t way_out(LineSegment segment, const std::vector<Spoke>& around) const {
        const Fan fan(dual_.points, cell_, around, segment, guard_);
        const std::size_t best = first_crossed(fan, segment);
        const bool leaves = best < fan.left() && !is_nearer(segment.to, cell_, fan.row(best));
        return leaves ? fan.row(best) : -1;
    }

    // Of the neighbours ahead, or the end of these if there are none.
    std::size_t first_crossed(const Fan& fan, LineSegment segment) const {
        std::size_t low = fan.ahead(), high = fan.left();
        while (low < high && high - low > 1) {
            const std::size_t middle = low + (high - low) / 2;
            const bool is_earlier =
                enters_before(Lift{}, segment, site(cell_), site(fan.row(middle)),
                              site(fan.row(middle - 1)), guard_);
            (is_earlier ? low : high) = middle;
        }
        return low;
    }

    void collect_ties(const Fan& fan, std::size_t i, Point p) {
        const std::size_t before = tied_.size(), count = fan.count();
        for (std::size_t k = 0; k < count && gap(p, fan.row(i + k)) == 0; ++k)
            tied_.push_back(fan.row(i + k));
        if (tied_.size() == before) return;
        for (std::size_t k = 1; k < count && gap(p, fan.row(i + count - k)) == 0; ++k)
            tied_.push_back(fan.row(i + count - k));
    }

    // The corner is where the segment ends, if that is in this cell.
    void note_ties(LineSegment segment, std::int32_t edge, std::int32_t corner) {
        for (const std::int32_t row : tied_) {
            if (corner >= 0) ties_.push_back({corner, -1, cell_, row});
            if (gap(segment.from, row) == 0) ties_.push_back({-1, edge, cell_, row});
        }
    }

    // The last passage of a ring and its first are one.
    static void join(const Passage& last, Passage& first) {
        first.in = last.in;
        if (last.count > 0) first.first = last.first;
        first.count += last.count;
    }

    const Dual& dual_;
    const Spokes& spokes_;
    const Domain& domain_;
    Patience patience_;
    std::vector<Passage>& found_;
    std::vector<Tie>& ties_;
    Guard guard_ = Guard::anywhere();
    std::int32_t cell_ = -1;
    std::vector<Spoke> around_;  // the cell listed last
    std::int32_t listed_ = -1;
    std::unordered_map<std::int32_t, Hub> hubs_;
    std::vector<std::int32_t>
        tied_;  // neighbours of the cell to whom the end of a segment is as near
};

}  // namespace

Clipping find_passages(const Dual& dual, const Spokes& spokes, const Domain& domain,
                       Interrupt& interrupt, std::vector<Passage>& found, std::vector<Tie>& ties) {
    switch (dual.kind) {
        case Dual::Kind::plain:
            return Following<Paraboloid>(dual, spokes, domain, interrupt, found, ties).run();
        case Dual::Kind::weights:
            return Following<ByWeight>(dual, spokes, domain, interrupt, found, ties).run();
        case Dual::Kind::radii:
            return Following<ByRadius>(dual, spokes, domain, interrupt, found, ties).run();
    }
    return Clipping::done;
}

}  // namespace liftmesh
