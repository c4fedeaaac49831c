// Faces whose circumdisks reach a box: with natural neighbours, a height in the box depends on
// those that have the point inside their circles. Disks are rounded outwards (`territory.hpp`), so
// there may be a few too many.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/point.hpp"
#include "tiles/territory.hpp"

namespace liftmesh {

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

}  // namespace liftmesh
