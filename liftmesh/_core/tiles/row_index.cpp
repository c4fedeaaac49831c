#include "tiles/row_index.hpp"

#include <algorithm>

namespace liftmesh {

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
