// The heights -|p|^2 hide every point that is no corner of the convex hull: it lies between
// corners, and a concave function is higher there. So the corners are found first; then they take
// the stages of Delaunay's triangulation, with these heights in the place of |p|^2. Points in
// convex position stay so in every part: no merge hides any of them, and no three are on one line.

#include "base/floating_point.hpp"
#include "base/input.hpp"
#include "base/pair.hpp"
#include "base/point.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/divide_conquer.hpp"
#include "parallel/blocks.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

// The corners of the convex hull of the rows: extreme points, so none between two others.

struct StrictHull {
    std::vector<Site> corners;  // by x, then y, each with the first row there
    std::vector<Site> copies;   // further rows at corners
    std::vector<Row> skipped;   // non-finite rows, ascending
    bool is_complete = false;   // not interrupted
};

// A point with others in all four open quadrants around it is no corner. So each share of the rows
// keeps one far point in each diagonal direction; the points strictly inside the box between them
// are dropped, by comparisons alone (Akl and Toussaint, 1978, have the quadrilateral). What is left
// is collected. Whenever it has doubled, it is sorted, and the monotone chains of Andrew (1979)
// remain. Finally the hulls of shares are united in pairs. O(n log n) on every input.

bool is_before_row(const Site& a, const Site& b) {
    return a.point == b.point ? a.row < b.row : before_xy(a.point, b.point);
}

// A far point north-east, north-west, south-west and south-east, and the box between them.
class Corners {
 public:
    bool surround(Pair p) const {
        const PairBits inside = (p > low_) & (p < high_);
        return (inside[0] & inside[1]) != 0;
    }
    // Which points are taken is a matter of speed alone, and so is rounding here.
    void add(Pair p) {
        const double x = p[0] / 2, y = p[1] / 2, reach[4] = {x + y, y - x, -x - y, x - y};
        bool is_farther = false;
        for (std::size_t k = 0; k < 4; ++k) {
            if (!(reach[k] > reach_[k])) continue;
            reach_[k] = reach[k];
            at_[k] = p;
            is_farther = true;
        }
        if (!is_farther) return;
        low_ = Pair{std::max(at_[1][0], at_[2][0]), std::max(at_[2][1], at_[3][1])};
        high_ = Pair{std::min(at_[0][0], at_[3][0]), std::min(at_[0][1], at_[1][1])};
    }

 private:
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    std::array<double, 4> reach_ = {-infinity, -infinity, -infinity, -infinity};
    std::array<Pair, 4> at_{};
    Pair low_{}, high_{};  // no point is inside an empty box
};

// Marks the sites on the chain to the right of the way from the first to the last of them, or back.
template <bool back>
void mark_chain(const std::vector<Site>& sites, std::vector<std::uint8_t>& is_corner) {
    std::vector<std::uint32_t> chain;
    const auto at = [&](std::size_t i) { return sites[back ? sites.size() - 1 - i : i].point; };
    const auto is_passed = [&](std::size_t i) {
        const std::size_t top = chain.size();
        return top > 1 && orient2d(at(chain[top - 2]), at(chain[top - 1]), at(i)) <= 0;
    };
    for (std::size_t i = 0; i < sites.size(); ++i) {
        while (is_passed(i)) chain.pop_back();
        chain.push_back(static_cast<std::uint32_t>(i));
    }
    for (const std::uint32_t i : chain) is_corner[back ? sites.size() - 1 - i : i] = true;
}

// The corner at a position; the end where there is none.
std::vector<Site>::const_iterator corner_at(const std::vector<Site>& corners, Point p) {
    const auto at = std::lower_bound(corners.begin(), corners.end(), p,
                                     [](const Site& a, Point b) { return before_xy(a.point, b); });
    return at != corners.end() && at->point == p ? at : corners.end();
}

// The hull of a share of the rows, and candidates that have come since.
class HullShare {
 public:
    HullShare() = default;
    HullShare(std::size_t first, std::size_t last) : first_(first), last_(last) {}

    void read(const Input& input, Interrupt& interrupt) {
        for_each_in_blocks(last_ - first_, interrupt, [&](std::size_t i) {
            const std::size_t row = first_ + i;
            const Pair p = pair(input[row]);
            if (far_.surround(p)) return;
            if (is_finite(p)) {
                add({point(p), static_cast<Row>(row)});
            } else {
                skipped_.push_back(static_cast<Row>(row));
            }
        });
        settle();
        interrupt.advance(work::sorting * (last_ - first_));
    }

    void unite(HullShare& other) {
        append(sites_, other.sites_);
        append(copies_, other.copies_);
        append(skipped_, other.skipped_);
        settle();
    }

    StrictHull result() && {
        const auto is_at_a_corner = [&](const Site& copy) {
            return corner_at(sites_, copy.point) != sites_.end();
        };
        copies_.erase(std::partition(copies_.begin(), copies_.end(), is_at_a_corner),
                      copies_.end());
        return {std::move(sites_), std::move(copies_), std::move(skipped_), true};
    }

 private:
    template <class Item>
    static void append(std::vector<Item>& to, std::vector<Item>& from) {
        to.insert(to.end(), from.begin(), from.end());
        std::vector<Item>().swap(from);
    }

    void add(const Site& site) {
        constexpr std::size_t few = 4096;
        far_.add(pair(site.point));
        sites_.push_back(site);
        if (sites_.size() >= 2 * settled_ + few) settle();
    }

    // Sorts the candidates among the corners so far, and keeps the corners of all.
    void settle() {
        const auto middle = sites_.begin() + static_cast<std::ptrdiff_t>(settled_);
        if (!std::is_sorted(middle, sites_.end(), is_before_row))
            std::sort(middle, sites_.end(), is_before_row);
        std::inplace_merge(sites_.begin(), middle, sites_.end(), is_before_row);
        set_copies_aside();
        keep_corners();
        settled_ = sites_.size();
    }

    void set_copies_aside() {
        std::size_t kept = 0;
        for (const Site& site : sites_) {
            if (kept != 0 && sites_[kept - 1].point == site.point) {
                copies_.push_back(site);
            } else {
                sites_[kept++] = site;
            }
        }
        sites_.resize(kept);
    }

    void keep_corners() {
        std::vector<std::uint8_t> is_corner(sites_.size());
        mark_chain<false>(sites_, is_corner);
        mark_chain<true>(sites_, is_corner);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < sites_.size(); ++i)
            if (is_corner[i]) sites_[kept++] = sites_[i];
        sites_.resize(kept);
    }

    std::size_t first_ = 0, last_ = 0;
    Corners far_;
    std::vector<Site> sites_;   // the first `settled_` are corners, sorted
    std::vector<Site> copies_;  // of what was a corner once
    std::vector<Row> skipped_;
    std::size_t settled_ = 0;
};

// Each row is read once: another thread may change it meanwhile.
StrictHull strict_hull(const Input& input, ThreadPool& pool) {
    constexpr std::size_t worth_sharing = std::size_t{1} << 15;
    const std::size_t most = pool.size() == 1 ? 1 : 4 * pool.size();
    const std::size_t count = std::clamp<std::size_t>(input.rows / worth_sharing, 1, most);
    std::vector<HullShare> shares;
    for (std::size_t i = 0; i < count; ++i)
        shares.emplace_back(input.rows * i / count, input.rows * (i + 1) / count);
    if (!pool.run(count, [&](std::size_t i) { shares[i].read(input, pool.interrupt()); }))
        return {};
    for (std::size_t step = 1; step < count; step *= 2) {
        const auto unite = [&](std::size_t i) {
            const std::size_t at = 2 * step * i;
            if (at + step < count) shares[at].unite(shares[at + step]);
        };
        if (!pool.run((count + 2 * step - 1) / (2 * step), unite)) return {};
    }
    if (pool.interrupt().requested()) return {};
    return std::move(shares[0]).result();
}

constexpr std::size_t after_sorting = work::triangulating + work::compacting;

class FarthestRun {
 public:
    FarthestRun(const Input& input, ThreadPool& pool) : input_(input), pool_(pool) {}

    Regular run(bool skip_non_finite) {
        Regular outcome;
        outcome.status = Status::interrupted;
        StrictHull hull = strict_hull(input_, pool_);
        if (!hull.is_complete) return outcome;
        if (!hull.skipped.empty() && !skip_non_finite) {
            outcome.status = Status::non_finite;
            outcome.row = hull.skipped.front();
            return outcome;
        }
        if (!list_others(hull, outcome)) return outcome;
        outcome.skipped = std::move(hull.skipped);
        if (hull.corners.size() < 3) {
            name_line(hull, outcome);
        } else {
            triangulate(hull, outcome);
        }
        return outcome;
    }

 private:
    Input corners_of(const StrictHull& hull) const {
        return {reinterpret_cast<const std::byte*>(hull.corners.data()), hull.corners.size(),
                sizeof(Site), sizeof(double), false};
    }

    bool list_others(StrictHull& hull, Regular& outcome) {
        std::vector<std::uint8_t> is_known(input_.rows);
        for (const Site& corner : hull.corners) is_known[corner.row] = true;
        for (const Site& copy : hull.copies) is_known[copy.row] = true;
        for (const Row row : hull.skipped) is_known[row] = true;
        list_duplicates(hull, outcome.duplicates);
        return select(
            input_.rows, pool_, [&](std::size_t row) { return !is_known[row]; }, outcome.hidden);
    }

    static void list_duplicates(StrictHull& hull, std::vector<Duplicate>& duplicates) {
        const auto by_row = [](const Site& a, const Site& b) { return a.row < b.row; };
        std::sort(hull.copies.begin(), hull.copies.end(), by_row);
        for (const Site& copy : hull.copies)
            duplicates.push_back({copy.row, corner_at(hull.corners, copy.point)->row});
    }

    // Two or fewer corners: the ends of a line take the place of the hull.
    void name_line(const StrictHull& hull, Regular& outcome) {
        Order order;
        const Delaunay all = start(input_, true, pool_, order);
        outcome.status = all.status == Status::ok ? Status::collinear : all.status;
        outcome.distinct = all.distinct;
        outcome.result.hull_count = hull.corners.size();
        outcome.result.hull = allocate<std::int32_t>(hull.corners.size());
        for (std::size_t i = 0; i < hull.corners.size(); ++i)
            outcome.result.hull[i] = static_cast<std::int32_t>(hull.corners[i].row);
    }

    void triangulate(StrictHull& hull, Regular& outcome) {
        Order order;
        outcome.status = start(corners_of(hull), false, pool_, order).status;
        if (outcome.status != Status::ok) return;
        for (std::size_t i = 0; i < order.count; ++i)
            order.sites[i].row = hull.corners[order.sites[i].row].row;
        pool_.interrupt().advance(after_sorting * (input_.rows - order.count));
        hull = {};
        Construction construction;
        outcome.status =
            divide_and_conquer(Farthest{}, order.scale.guard, order, pool_, construction);
        if (outcome.status == Status::ok)
            outcome.status = compact(std::move(construction), pool_, outcome.result);
    }

    const Input& input_;
    ThreadPool& pool_;
};

}  // namespace

Regular farthest(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(input.rows), interrupt);
    interrupt.expect(input.rows * (work::sorting + after_sorting));
    return FarthestRun(input, pool).run(skip_non_finite);
}

}  // namespace liftmesh
