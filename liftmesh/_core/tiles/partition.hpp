// Which tile a point belongs to, and points sorted by tile.
//
// Tiles are the cells of a kd tree whose cuts compare both coordinates: a point goes right if it is
// not before the cut, by the coordinate across which the cut goes, then by the other. So equal
// points share a tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "base/status.hpp"
#include "tiles/record.hpp"
#include "tiles/territory.hpp"

namespace liftmesh {

struct Cut {
    Axis axis;
    Point at;
    std::int32_t children[2];  // the number of a cut, or ~tile
};

struct Partition {
    bool is_complete = false;          // the interrupt did not come first
    Buffer<Record> records;            // by tile, and in the order of the rows within one
    std::vector<std::int64_t> begins;  // where each tile begins, and the end
    std::vector<Box> boxes;            // tight, of each tile that has points
    std::vector<RowId> skipped;        // rows that are not finite
};

// The rows are numbered from `first`. Without cuts there is one tile.
Partition partition(const Input& rows, RowId first, std::span<const Cut> cuts, std::size_t tiles,
                    Interrupt& interrupt);

}  // namespace liftmesh
