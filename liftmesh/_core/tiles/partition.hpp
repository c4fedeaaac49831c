// Which tile a point belongs to, and points sorted by tile.
//
// Tiles are the cells of a kd tree whose cuts compare both coordinates: a point goes right if it is
// not before the cut, by the coordinate across which the cut goes, then by the other. So equal
// points share a tile.
#pragma once

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
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

// Faces whose circumdisks reach a box: with natural neighbours, a height in the box depends on
// those that have the point inside their circles. Disks are rounded outwards (`territory.hpp`), so
// there may be a few too many.

// Faces between points, three corners each.
struct Corners {
    std::span<const Point> points;
    std::span<const std::int32_t> rows;

    std::size_t count() const { return rows.size() / 3; }
    bool are_valid() const;  // whether all rows are those of points
    Disk disk(std::size_t face) const;
};

// A box that holds the circumdisks of all faces.
Box reach_of(const Corners& faces);

// Says of each face whether its disk may have a point of the box.
void find_reaching(const Corners& faces, const Box& box, bool* reaches);

// Where rows are in an ascending list of rows: the corners of triangles among the points of a tile.

// A table says in which part of the list rows with the same leading bits are. It has about as many
// entries as the list, so that such a part has one or two rows if they are spread evenly; whatever
// its length, the row is found by halving.
class RowIndex {
 public:
    explicit RowIndex(std::span<const RowId> rows);  // ascending, none twice

    // The place of a row, or -1.
    std::int32_t find(RowId row) const;

 private:
    std::size_t part_of(RowId row) const {
        return static_cast<std::size_t>(
            (static_cast<std::uint64_t>(row) - static_cast<std::uint64_t>(first_)) >> shift_);
    }

    std::span<const RowId> rows_;
    RowId first_ = 0, last_ = -1;
    unsigned shift_ = 0;
    std::vector<std::uint32_t> begins_;
};

}  // namespace liftmesh
