// One counting sort.

#include "tiles/partition.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"

namespace liftmesh {

namespace {

constexpr std::int32_t nowhere = -1;

std::int32_t tile_of(Point p, std::span<const Cut> cuts) {
    if (cuts.empty()) return 0;
    std::int32_t at = 0;
    do {
        const Cut& cut = cuts[static_cast<std::size_t>(at)];
        at = cut.children[!before(cut.axis, p, cut.at)];
    } while (at >= 0);
    return ~at;
}

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
    const auto assign = [&](std::size_t i) {
        const Point p = rows[i];
        tile[i] = is_finite(p) ? tile_of(p, cuts) : nowhere;
        if (tile[i] == nowhere)
            out.skipped.push_back(first + static_cast<RowId>(i));
        else
            ++out.begins[static_cast<std::size_t>(tile[i]) + 1];
    };
    if (!for_each_in_blocks(rows.rows, interrupt, assign)) return out;
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
