// A planar point, and the two lexicographic orders by which the plane is cut.
#pragma once

#include <cstdint>

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

}  // namespace liftmesh
