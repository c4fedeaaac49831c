// The graph of a caller's disks: scaled, inserted in an order of its own, and read out by rows.
#pragma once

#include "apollonius/disk.hpp"
#include "base/point.hpp"
#include "base/status.hpp"

namespace liftmesh::apollonius {

// Coordinates and radii are multiples of a power of two, and less than so many times as large.
inline constexpr int widest_range = 256;

// Of the numbers of all disks: the lowest bit, the first above the highest, and whose these are.
struct Range {
    int low = 0, high = 0;
    Row finest = 0, largest = 0;
};
Range range_of(const std::vector<Disk>& disks);

// Disks as `disk.hpp` wants them: divided by a power of two.
struct Scaled {
    std::vector<Disk> disks;
    int scale;
    Signs signs;
};
Scaled scaled(std::vector<Disk> disks);

// Rows, counter-clockwise from the lowest. The order is that of the rows.
struct Triangle {
    std::array<std::int32_t, 3> corners, neighbors;  // -1 is infinity
    Circle circle;
};

// The circle of a triangle whose corners come in this order. Rounded, then multiplied by 2^scale.
Circle circle_of(std::array<Disk, 3> corners, int scale);

struct Outcome {
    Status status = Status::ok;
    std::vector<Triangle> triangles;
    std::vector<std::array<std::int32_t, 2>> hull;  // counter-clockwise, from the least pair on
    std::vector<std::array<Row, 2>> hidden;         // ascending, each with one that contains it
    std::vector<std::array<Row, 2>> duplicates;     // each row, and the lowest that is equal
};

// Of disks of a range that is not too wide, with finite coordinates and radii, these not negative.
// The outcome does not depend on the secret, and nobody who does not know it can make disks for
// which the order of insertion is a bad one.
Outcome apollonius(std::vector<Disk> disks, std::uint64_t secret, Interrupt& interrupt);

}  // namespace liftmesh::apollonius
