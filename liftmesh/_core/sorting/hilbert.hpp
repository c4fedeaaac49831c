// Where points are along a Hilbert curve through their box: neighbours on it are near in the plane.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"

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

}  // namespace liftmesh
