// Where rows are in an ascending list of rows: the corners of triangles among the points of a tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tiles/record.hpp"

namespace liftmesh {

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
