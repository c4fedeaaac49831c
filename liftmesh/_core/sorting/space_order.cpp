#include "sorting/space_order.hpp"

#include "parallel/blocks.hpp"
#include "predicates/lattice.hpp"
#include "sorting/hilbert.hpp"

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

struct PlacedRow {
    std::uint64_t place;
    Row row;
};

class SpaceSort {
 public:
    SpaceSort(SpaceRows rows, Interrupt& interrupt, SpaceOrder& order)
        : rows_(std::move(rows)), interrupt_(interrupt), order_(order) {}

    bool run() {
        if (!find_places()) return false;
        std::sort(placed_.get(), placed_.get() + count_,
                  [](const PlacedRow& a, const PlacedRow& b) {
                      return std::tie(a.place, a.row) < std::tie(b.place, b.row);
                  });
        if (interrupt_.requested()) return false;
        sort_equal_places();
        return keep_distinct();
    }

 private:
    bool find_places() {
        placed_ = allocate<PlacedRow>(rows_.count);
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
        return for_each_in_blocks(count_, interrupt_, [&](std::size_t i) {
            placed_[i].place = curve(rows_.points[placed_[i].row]);
        });
    }

    const SpacePoint& at(const PlacedRow& item) const { return rows_.points[item.row]; }

    void sort_equal_places() {
        PlacedRow* const end = placed_.get() + count_;
        for (PlacedRow *first = placed_.get(), *last; first != end; first = last) {
            last = std::find_if(first, end,
                                [&](const PlacedRow& p) { return p.place != first->place; });
            if (last - first < 2) continue;
            std::sort(first, last, [this](const PlacedRow& a, const PlacedRow& b) {
                return at(a) == at(b) ? a.row < b.row : before_xyz(at(a), at(b));
            });
        }
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
        std::sort(order_.duplicates.begin(), order_.duplicates.end(),
                  [](const Duplicate& a, const Duplicate& b) { return a.row < b.row; });
        return done;
    }

    SpaceRows rows_;
    Interrupt& interrupt_;
    SpaceOrder& order_;
    Buffer<PlacedRow> placed_;
    std::size_t count_ = 0;
    SpaceScale scale_;
};

}  // namespace

bool sort_in_space(SpaceRows rows, Interrupt& interrupt, SpaceOrder& order) {
    return SpaceSort(std::move(rows), interrupt, order).run();
}

}  // namespace liftmesh
