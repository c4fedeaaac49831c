// One pass learns the range of the coordinates and finds what is not finite; a sample of the rows
// gives the cuts of a kd tree; a second pass counts the points of each cell and a third drops every
// point into its cell (a stable counting sort). Then each cell, which fits the cache, is freed of
// duplicates.

#include "order.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "blocks.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t cell_population = 96;
constexpr int deepest = 13;
constexpr std::size_t sample_per_cell = 8;
constexpr std::uint16_t no_cell = 0xffff;

class Arrangement {
 public:
    Arrangement(const Input& input, Interrupt& interrupt, Order& order)
        : input_(input), interrupt_(interrupt), order_(order) {}

    OrderResult run(bool skip_non_finite) {
        if (!survey()) return {Status::interrupted, 0};
        if (!order_.skipped.empty() && !skip_non_finite)
            return {Status::non_finite, order_.skipped.front()};
        const Scale scale(range_);
        order_.scale = scale;
        const bool done = scale.moves
                              ? distribute([&](std::size_t row) { return scale(input_[row]); })
                              : distribute([&](std::size_t row) { return input_[row]; });
        return {done && keep_distinct_in_cells() ? Status::ok : Status::interrupted, 0};
    }

 private:
    bool survey() {
        return for_each_in_blocks(input_.rows, interrupt_, [&](std::size_t row) {
            const Point p = input_[row];
            if (is_finite(p)) {
                range_.add(p);
            } else {
                order_.skipped.push_back(static_cast<Row>(row));
            }
        });
    }

    template <class Read>
    bool distribute(Read read) {
        const std::size_t finite = input_.rows - order_.skipped.size();
        const Cuts cuts = learn_cuts(read, finite);
        order_.depth = cuts.depth();
        order_.cell_starts.assign(cuts.cells() + 1, 0);
        const auto cell_of = std::make_unique_for_overwrite<std::uint16_t[]>(input_.rows);
        const bool counted = for_each_in_blocks(input_.rows, interrupt_, [&](std::size_t row) {
            const Point p = read(row);
            if (!is_finite(p)) {
                cell_of[row] = no_cell;
                return;
            }
            const std::size_t cell = cuts.cell(p);
            cell_of[row] = static_cast<std::uint16_t>(cell);
            ++order_.cell_starts[cell + 1];
        });
        if (!counted) return false;
        for (std::size_t cell = 0; cell < cuts.cells(); ++cell)
            order_.cell_starts[cell + 1] += order_.cell_starts[cell];
        return scatter(read, cell_of.get());
    }

    template <class Read>
    bool scatter(Read read, const std::uint16_t* cell_of) {
        order_.points = std::make_unique_for_overwrite<Point[]>(order_.cell_starts.back());
        order_.rows = std::make_unique_for_overwrite<Row[]>(order_.cell_starts.back());
        std::vector<std::size_t> cursor = order_.cell_starts;
        return for_each_in_blocks(input_.rows, interrupt_, [&](std::size_t row) {
            if (cell_of[row] == no_cell) return;
            const std::size_t at = cursor[cell_of[row]]++;
            order_.points[at] = read(row);
            order_.rows[at] = static_cast<Row>(row);
        });
    }

    // Rows are sampled by a Weyl sequence: evenly, and out of step with any raster.
    template <class Read>
    Cuts learn_cuts(Read read, std::size_t finite) {
        const int depth =
            std::clamp(static_cast<int>(std::bit_width(finite / cell_population)) - 1, 0, deepest);
        const std::size_t wanted = sample_per_cell << depth;
        std::vector<Point> sample;
        if (depth == 0) return Cuts(std::move(sample), 0);
        sample.reserve(wanted);
        std::uint64_t state = 0;
        // Rows that were finite a moment ago are so again, unless somebody writes them meanwhile.
        for (std::size_t tries = 0; sample.size() < wanted; ++tries) {
            if (tries > wanted + 64 * input_.rows) return Cuts({}, 0);
            state += 0x9e3779b97f4a7c15u;
            const auto row = static_cast<std::size_t>(((state >> 32) * input_.rows) >> 32);
            if (const Point p = read(row); is_finite(p)) sample.push_back(p);
        }
        return Cuts(std::move(sample), depth);
    }

    bool keep_distinct_in_cells() {
        Point* points = order_.points.get();
        Row* rows = order_.rows.get();
        std::size_t kept = 0;
        for (std::size_t cell = 0; cell + 1 < order_.cell_starts.size(); ++cell) {
            if (interrupt_.requested()) return false;
            const std::size_t start = order_.cell_starts[cell];
            const std::size_t count = order_.cell_starts[cell + 1] - start;
            const std::size_t distinct =
                keep_distinct(points + start, rows + start, count, order_.duplicates);
            if (kept != start) {
                std::copy_n(points + start, distinct, points + kept);
                std::copy_n(rows + start, distinct, rows + kept);
            }
            order_.cell_starts[cell] = kept;
            kept += distinct;
        }
        order_.cell_starts.back() = kept;
        order_.count = kept;
        return sort_duplicates();
    }

    // By row: each goes to the place of its row, and the places are read in turn.
    bool sort_duplicates() {
        if (order_.duplicates.empty()) return true;
        constexpr Row none = ~Row{0};
        std::vector<Row> kept(input_.rows, none);
        for (const Duplicate& pair : order_.duplicates) kept[pair.row] = pair.kept;
        order_.duplicates.clear();
        return for_each_in_blocks(kept.size(), interrupt_, [&](std::size_t row) {
            if (kept[row] != none) order_.duplicates.push_back({static_cast<Row>(row), kept[row]});
        });
    }

    const Input& input_;
    Interrupt& interrupt_;
    Order& order_;
    Range range_;
};

}  // namespace

OrderResult arrange(const Input& input, bool skip_non_finite, Interrupt& interrupt, Order& order) {
    return Arrangement(input, interrupt, order).run(skip_non_finite);
}

bool sort_by_row(const Input& input, Interrupt& interrupt, Order& order) {
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> place(input.rows, none);
    for (std::size_t i = 0; i < order.count; ++i)
        place[order.rows[i]] = static_cast<std::uint32_t>(i);
    auto points = std::make_unique_for_overwrite<Point[]>(order.count);
    std::size_t next = 0;
    const bool done = for_each_in_blocks(input.rows, interrupt, [&](std::size_t row) {
        if (place[row] == none) return;
        points[next] = order.points[place[row]];
        order.rows[next++] = static_cast<Row>(row);
    });
    order.points = std::move(points);
    order.depth = 0;
    order.cell_starts = {0, order.count};
    return done;
}

}  // namespace liftmesh
