// One counting sort.

#include "tiles/partition.hpp"

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"

namespace liftmesh {

namespace {

constexpr std::int32_t nowhere = -1;

// Down the tree with several points at a time: the steps of one wait for each other, those of
// different points do not, and none of them branches on where a point lies.
class Descent {
 public:
    static constexpr std::size_t width = 8;

    explicit Descent(std::span<const Cut> cuts) : cuts_(cuts) {}

    // The tiles of `width` points.
    void find(const Point* points, std::int32_t* tiles) const {
        std::int32_t at[width];
        std::fill_n(at, width, cuts_.empty() ? ~0 : 0);
        for (bool is_above = !cuts_.empty(); is_above;) {
            is_above = false;
            for (std::size_t i = 0; i < width; ++i) {
                at[i] = step(at[i], points[i]);
                is_above |= at[i] >= 0;
            }
        }
        for (std::size_t i = 0; i < width; ++i) tiles[i] = ~at[i];
    }

 private:
    std::int32_t step(std::int32_t at, Point p) const {
        const Cut& cut = cuts_[static_cast<std::size_t>(std::max(at, 0))];
        const bool by_x = before_xy(p, cut.at), by_y = before_yx(p, cut.at);
        const bool is_x = cut.axis == Axis::x;
        const std::int32_t next = cut.children[!((is_x & by_x) | (!is_x & by_y))];
        return at < 0 ? at : next;
    }

    std::span<const Cut> cuts_;
};

void extend(Box& box, Point p) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Box empty = {{infinity, infinity}, {-infinity, -infinity}};

}  // namespace

Partition partition(const Input& rows, RowId first, std::span<const Cut> cuts, std::size_t tiles,
                    Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Partition out;
    out.begins.resize(tiles + 1);
    out.boxes.assign(tiles, empty);
    const auto tile = allocate<std::int32_t>(rows.rows);
    const Descent descent(cuts);
    const auto assign = [&](std::size_t group) {
        const std::size_t begin = group * Descent::width;
        const std::size_t count = std::min(Descent::width, rows.rows - begin);
        Point points[Descent::width] = {};
        for (std::size_t i = 0; i < count; ++i) points[i] = rows[begin + i];
        std::int32_t found[Descent::width];
        descent.find(points, found);
        for (std::size_t i = 0; i < count; ++i) {
            tile[begin + i] = is_finite(points[i]) ? found[i] : nowhere;
            if (tile[begin + i] == nowhere)
                out.skipped.push_back(first + static_cast<RowId>(begin + i));
            else
                ++out.begins[static_cast<std::size_t>(found[i]) + 1];
        }
    };
    const std::size_t groups = (rows.rows + Descent::width - 1) / Descent::width;
    if (!for_each_in_blocks(groups, interrupt, assign)) return out;
    std::partial_sum(out.begins.begin(), out.begins.end(), out.begins.begin());
    out.records = allocate<Record>(static_cast<std::size_t>(out.begins.back()));
    std::vector<std::int64_t> next(out.begins.begin(), out.begins.end() - 1);
    const auto place = [&](std::size_t i) {
        if (tile[i] == nowhere) return;
        const auto t = static_cast<std::size_t>(tile[i]);
        out.records[static_cast<std::size_t>(next[t]++)] = {first + static_cast<RowId>(i), rows[i]};
        extend(out.boxes[t], rows[i]);
    };
    out.is_complete = for_each_in_blocks(rows.rows, interrupt, place);
    return out;
}

}  // namespace liftmesh
