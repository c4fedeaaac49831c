
#include "tiles/partition.hpp"

namespace liftmesh {

bool Corners::are_valid() const {
    return std::all_of(rows.begin(), rows.end(), [this](std::int32_t row) {
        return row >= 0 && static_cast<std::size_t>(row) < points.size();
    });
}

Disk Corners::disk(std::size_t face) const {
    const auto corner = [&](std::size_t k) {
        return points[static_cast<std::size_t>(rows[3 * face + k])];
    };
    return {corner(0), corner(1), corner(2)};
}

Box reach_of(const Corners& faces) {
    constexpr double far = std::numeric_limits<double>::infinity();
    Box found = {{far, far}, {-far, -far}};
    for (std::size_t i = 0; i < faces.count(); ++i) {
        const Box each = faces.disk(i).bounds();
        found.low = {std::min(found.low.x, each.low.x), std::min(found.low.y, each.low.y)};
        found.high = {std::max(found.high.x, each.high.x), std::max(found.high.y, each.high.y)};
    }
    return found;
}

void find_reaching(const Corners& faces, const Box& box, bool* reaches) {
    for (std::size_t i = 0; i < faces.count(); ++i) {
        const Disk disk = faces.disk(i);
        reaches[i] = !disk.is_known() || !disk.is_clear_of(box);
    }
}

RowIndex::RowIndex(std::span<const RowId> rows) : rows_(rows) {
    if (rows.empty()) return;
    first_ = rows.front();
    last_ = rows.back();
    while (part_of(last_) > rows.size()) ++shift_;
    begins_.resize(part_of(last_) + 2);
    for (const RowId row : rows) ++begins_[part_of(row) + 1];
    for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
}

std::int32_t RowIndex::find(RowId row) const {
    if (row < first_ || row > last_) return -1;
    const std::size_t part = part_of(row);
    const auto begin = rows_.begin() + begins_[part], end = rows_.begin() + begins_[part + 1];
    const auto found = std::lower_bound(begin, end, row);
    return found != end && *found == row ? static_cast<std::int32_t>(found - rows_.begin()) : -1;
}

}  // namespace liftmesh
