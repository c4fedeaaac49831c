// The bounding box of points.
#pragma once

#include <algorithm>

#include "base/point.hpp"

namespace liftmesh {

struct Bounds {
    Point low, high;

    explicit Bounds(Point p) : low(p), high(p) {}
    void add(Point p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    // The axis across which a cut leaves rounder parts, with a shorter seam.
    Axis longer() const { return high.x - low.x >= high.y - low.y ? Axis::x : Axis::y; }
};

}  // namespace liftmesh
