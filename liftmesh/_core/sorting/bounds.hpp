// The bounding box of points.
#pragma once

#include <limits>

#include "base/pair.hpp"
#include "base/point.hpp"

namespace liftmesh {

struct Bounds {
    Pair low{}, high{};

    Bounds() = default;
    explicit Bounds(Pair p) : low(p), high(p) {}
    Bounds(Pair lowest, Pair highest) : low(lowest), high(highest) {}
    static Bounds nothing() {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        return {Pair{infinity, infinity}, Pair{-infinity, -infinity}};
    }
    void add(Pair p) {
        low = least(low, p);
        high = greatest(high, p);
    }
    void add(const Bounds& other) {
        low = least(low, other.low);
        high = greatest(high, other.high);
    }
    // The axis across which a cut leaves rounder parts, with a shorter seam.
    Axis longer() const {
        const Pair size = high - low;
        return size[0] >= size[1] ? Axis::x : Axis::y;
    }
};

}  // namespace liftmesh
