// A point of a tiled input and its row in the whole of it, as tiles and frontiers store them.
#pragma once

#include <cstdint>
#include <span>

#include "base/input.hpp"
#include "base/point.hpp"

namespace liftmesh {

using RowId = std::int64_t;  // the rows of all tiles together may exceed 32 bits

struct Record {
    RowId id;
    Point point;
};

static_assert(sizeof(Record) == 24, "files hold records");

// Their points, read in place.
inline Input points_of(std::span<const Record> records) {
    const auto* first = reinterpret_cast<const std::byte*>(records.data());
    return {first + sizeof(RowId), records.size(), sizeof(Record), sizeof(double), false};
}

}  // namespace liftmesh
