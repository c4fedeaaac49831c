// A planar point, and the two lexicographic orders by which the plane is cut.
#pragma once

#include "base/standard.hpp"

namespace liftmesh {

using Vertex = std::uint32_t;  // position of a distinct point in kd order
using Row = std::uint32_t;     // row of the caller's array

struct Point {
    double x, y;
    bool operator==(const Point&) const = default;
};

enum class Axis : std::uint8_t { x, y };

constexpr Axis other(Axis axis) {
    return axis == Axis::x ? Axis::y : Axis::x;
}

constexpr double along(Axis axis, Point p) {
    return axis == Axis::x ? p.x : p.y;
}

// Bitwise operators avoid branches, which would be unpredictable.
inline bool before_xy(Point a, Point b) {
    return (a.x < b.x) | ((a.x == b.x) & (a.y < b.y));
}
inline bool before_yx(Point a, Point b) {
    return (a.y < b.y) | ((a.y == b.y) & (a.x < b.x));
}

inline bool before(Axis axis, Point a, Point b) {
    return axis == Axis::x ? before_xy(a, b) : before_yx(a, b);
}

// A distinct point of the input and the row that represents it.

struct Site {
    Point point;
    Row row;
};

// Hashes by multiplication (Knuth, "The Art of Computer Programming", volume 3, 6.4): their top
// bits depend on all that is hashed.

// Of 2^64, and odd: its multiples are evenly spread.
inline constexpr std::uint64_t golden_section = 0x9e3779b97f4a7c15u;

inline std::uint64_t hash(std::uint64_t key) {
    return key * golden_section;
}

// Lattice points differ in few bits, mostly the highest.
inline std::uint64_t hash(Point p) {
    return hash(std::bit_cast<std::uint64_t>(p.x)) +
           std::bit_cast<std::uint64_t>(p.y) * 0xd1b54a32d192ed03u;
}

}  // namespace liftmesh
