// Where points are along a Hilbert curve through their box: neighbours on it are near in the plane.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "predicates/orient3d.hpp"

namespace liftmesh {

// The place of a cell of a grid of 2^16 x 2^16 on Hilbert's curve.
inline std::uint32_t place_on_hilbert_curve(std::uint32_t x, std::uint32_t y) {
    std::uint32_t at = 0;
    for (std::uint32_t side = std::uint32_t{1} << 15; side > 0; side /= 2) {
        const std::uint32_t right = (x & side) != 0, upper = (y & side) != 0;
        at = 4 * at + ((3 * right) ^ upper);
        if (upper) continue;
        if (right) x = ~x, y = ~y;
        std::swap(x, y);
    }
    return at;
}

class HilbertCurve {
 public:
    using Place = std::uint32_t;
    using Box = Bounds;
    static Box no_box() { return Bounds::nothing(); }
    static void extend(Box& box, Point p) { box.add(pair(p)); }
    static bool before(Point a, Point b) { return before_xy(a, b); }

    explicit HilbertCurve(const Bounds& box) : low_{box.low[0] / 2, box.low[1] / 2} {
        // Halves, so that no difference overflows.
        const double size = std::fmax(box.high[0] / 2 - low_.x, box.high[1] / 2 - low_.y);
        size_ = size > 0 ? size : 1;
    }

    std::uint32_t operator()(Point p) const {
        return place_on_hilbert_curve(cell((p.x / 2 - low_.x) / size_),
                                      cell((p.y / 2 - low_.y) / size_));
    }

 private:
    static std::uint32_t cell(double part) {
        return part > 0 ? static_cast<std::uint32_t>(std::fmin(part, 1) * 65535) : 0;
    }

    Point low_;
    double size_;
};

// The same in space.

struct SpaceBox {
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    SpacePoint low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

    void add(const SpacePoint& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
};

// The place of a cell of a grid of 2^21 in each direction: J. Skilling, "Programming the Hilbert
// curve" (2004), without branches.
inline std::uint64_t place_on_hilbert_curve(std::array<std::uint32_t, 3> at) {
    constexpr int bits = 21;
    for (int bit = bits - 1; bit > 0; --bit) {
        const std::uint32_t below = (std::uint32_t{1} << bit) - 1;
        for (std::uint32_t& value : at) {
            const std::uint32_t is_set = 0 - (value >> bit & 1);
            const std::uint32_t exchanged = (at[0] ^ value) & below & ~is_set;
            value ^= exchanged;
            at[0] ^= exchanged | (below & is_set);
        }
    }
    at[1] ^= at[0];
    at[2] ^= at[1];
    std::uint32_t turned = at[2] >> 1;
    for (int shift = 1; shift < bits; shift *= 2) turned ^= turned >> shift;
    std::uint64_t place = 0;
    for (int bit = bits - 1; bit >= 0; --bit)
        for (const std::uint32_t value : at) place = place << 1 | ((value ^ turned) >> bit & 1);
    return place;
}

class HilbertCurveInSpace {
 public:
    using Place = std::uint64_t;
    using Box = SpaceBox;
    static Box no_box() { return {}; }
    static void extend(Box& box, const SpacePoint& p) { box.add(p); }
    static bool before(const SpacePoint& a, const SpacePoint& b) { return before_xyz(a, b); }

    explicit HilbertCurveInSpace(const SpaceBox& box)
        : low_{box.low.x / 2, box.low.y / 2, box.low.z / 2} {
        const double size = std::fmax(std::fmax(box.high.x / 2 - low_.x, box.high.y / 2 - low_.y),
                                      box.high.z / 2 - low_.z);
        size_ = size > 0 ? size : 1;
    }

    std::uint64_t operator()(const SpacePoint& p) const {
        return place_on_hilbert_curve(
            {cell(p.x / 2 - low_.x), cell(p.y / 2 - low_.y), cell(p.z / 2 - low_.z)});
    }

 private:
    std::uint32_t cell(double distance) const {
        const double part = distance / size_;
        return part > 0 ? static_cast<std::uint32_t>(std::fmin(part, 1) * 0x1fffff) : 0;
    }

    SpacePoint low_;
    double size_;
};

}  // namespace liftmesh
