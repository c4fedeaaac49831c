#include "sorting/space_order.hpp"

#include "parallel/blocks.hpp"
#include "predicates/lattice.hpp"
#include "sorting/along_curve.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh {

bool read_space(const Input& input, Interrupt& interrupt, SpaceRows& rows) {
    rows.points = allocate<SpacePoint>(input.rows);
    rows.count = input.rows;
    return for_each_in_blocks(input.rows, interrupt, [&](std::size_t row) {
        const Point planar = input[row];
        const SpacePoint p{planar.x, planar.y, input.height(row)};
        rows.points[row] = p;
        if (!is_finite(planar) || !std::isfinite(p.z))
            rows.skipped.push_back(static_cast<Row>(row));
    });
}

void SpaceScale::add(const SpacePoint& p) {
    range_.add(Pair{p.x, p.y});
    range_.add(Pair{p.z, 0});
    for (double value : {p.x, p.y, p.z})
        if (value != 0) lowest_bit_ = std::min(lowest_bit_, dyadic(value).exponent);
}

void SpaceScale::settle() {
    scale_ = Scale(range_, Trust::least_exponent);
    const double unit = range_.empty() ? 1.0 : std::ldexp(1.0, lowest_bit_);
    const double by = scale_.moves ? scale_.first : 1, again = scale_.moves ? scale_.second : 1;
    trust_ = Trust::of(scale_.guard, unit * by * again, range_.greatest() * by * again);
}

SpacePoint SpaceScale::operator()(const SpacePoint& p) const {
    if (!scale_.moves) return p;
    const Point planar = scale_({p.x, p.y});
    return {planar.x, planar.y, scale_({p.z, 0}).x};
}

namespace {

class SpaceSort {
 public:
    SpaceSort(SpaceRows rows, ThreadPool& pool, SpaceOrder& order)
        : rows_(std::move(rows)), pool_(pool), interrupt_(pool.interrupt()), order_(order) {}

    bool run() { return find_places() && sort() && keep_distinct(); }

 private:
    using Placed = PlacedRow<HilbertCurveInSpace>;
    static constexpr std::size_t length = std::size_t{1} << 14;  // of a task

    bool find_places() {
        placed_ = allocate<Placed>(rows_.count);
        SpaceBox box;
        auto skipped = rows_.skipped.begin();
        const auto add = [&](std::size_t row) {
            if (skipped != rows_.skipped.end() && *skipped == row) {
                ++skipped;
                return;
            }
            placed_[count_++].row = static_cast<Row>(row);
            box.add(rows_.points[row]);
            scale_.add(rows_.points[row]);
        };
        if (!for_each_in_blocks(rows_.count, interrupt_, add)) return false;
        scale_.settle();
        const HilbertCurveInSpace curve(box);
        return in_blocks(count_, length, pool_, [&](std::size_t i, std::size_t last, std::size_t) {
            interrupt_.advance(work::sorting / 2 * (last - i));
            for (; i < last; ++i) placed_[i].place = curve(rows_.points[placed_[i].row]);
        });
    }

    // By the first bits of the place, and then each part of the curve by the rest.
    bool sort() {
        constexpr int key_bits = 12, place_bits = 63;
        const std::size_t shares = std::clamp<std::size_t>(count_ / length, 1, pool_.size());
        CountingSort parts(count_, shares, std::size_t{1} << key_bits, pool_);
        auto sorted = allocate<Placed>(count_);
        const bool done = parts.sort(
            [this](const Share& share, auto visit) {
                for (std::size_t i = share.first; i < share.last; ++i) visit(placed_[i]);
            },
            [](const Placed& item) { return item.place >> (place_bits - key_bits); },
            [&](std::size_t to, const Placed& item) { sorted[to] = item; });
        if (!done) return false;
        placed_ = std::move(sorted);
        const std::vector<std::size_t> starts = std::move(parts).starts();
        const std::size_t tasks = count_ < length ? 1 : std::size_t{1} << (key_bits - 4);
        const std::size_t each = (starts.size() - 1) / tasks;
        const auto at = [this](Row row) -> const SpacePoint& { return rows_.points[row]; };
        return pool_.run(tasks, [&](std::size_t task) {
            const std::span part(&placed_[starts[task * each]],
                                 &placed_[starts[(task + 1) * each]]);
            interrupt_.advance(work::sorting / 2 * part.size());
            AlongCurve<HilbertCurveInSpace, decltype(at)>(at, interrupt_).sort(part);
        });
    }

    bool keep_distinct() {
        order_.points = allocate<SpacePoint>(count_);
        order_.rows = allocate<Row>(count_);
        const SpacePoint* kept = nullptr;
        const bool done = for_each_in_blocks(count_, interrupt_, [&](std::size_t i) {
            const Row row = placed_[i].row;
            if (kept != nullptr && *kept == rows_.points[row]) {
                order_.duplicates.push_back({row, order_.rows[order_.count - 1]});
                return;
            }
            kept = &rows_.points[row];
            order_.points[order_.count] = scale_(*kept);
            order_.rows[order_.count++] = row;
        });
        order_.trust = scale_.trust();
        const auto is_before = [](const Duplicate& a, const Duplicate& b) { return a.row < b.row; };
        return done && patient_sort(order_.duplicates, is_before, interrupt_);
    }

    SpaceRows rows_;
    ThreadPool& pool_;
    Interrupt& interrupt_;
    SpaceOrder& order_;
    Buffer<Placed> placed_;
    std::size_t count_ = 0;
    SpaceScale scale_;
};

}  // namespace

bool sort_in_space(SpaceRows rows, ThreadPool& pool, SpaceOrder& order) {
    return SpaceSort(std::move(rows), pool, order).run();
}

}  // namespace liftmesh
