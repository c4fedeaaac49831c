// Points on an integer lattice as wide as a machine word: the exact step between the filters and
// integers of any width.
//
// Coordinates are multiplied by the power of two that brings the largest just below 2^61. Where
// each is an integer then, which holds as long as their bits together span no more than 61, the
// products of two differences fit 128 bits. Multiplying and converting takes a few instructions a
// coordinate, and no branch depends on the exponents.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "predicates/wide.hpp"

namespace liftmesh {

// An integer vector between two points: its coordinates are below 2^62 in magnitude.
struct Step {
    std::int64_t x, y;
};

// Below 2^125 in magnitude.
inline Int128 cross(Step u, Step v) {
    return static_cast<Int128>(u.x) * v.y - static_cast<Int128>(u.y) * v.x;
}
inline Int128 dot(Step u, Step v) {
    return static_cast<Int128>(u.x) * v.x + static_cast<Int128>(u.y) * v.y;
}

// K points.
template <int K>
class FixedPoint {
 public:
    explicit FixedPoint(const Point (&points)[K]) {
        Pair largest = magnitudes(pair(points[0])), zero = pair(points[0]) * 0.0;
        for (int i = 1; i < K; ++i) {
            largest = greatest(largest, magnitudes(pair(points[i])));
            zero += pair(points[i]) * 0.0;
        }
        // Another thread may have put there what is not finite, and so no integer.
        if (!(zero[0] + zero[1] == 0)) return;
        // A double whose biased exponent is `top` is below 2^(top - 1022).
        constexpr int bias = 1023, width = 61, mantissa = 52;
        const int top = static_cast<int>(
            std::bit_cast<std::uint64_t>(std::max(largest[0], largest[1])) >> mantissa);
        const int shift = width + bias - 1 - top;
        if (shift >= bias) return;
        shift_ = shift;
        const auto power = [](int exponent) {
            return std::bit_cast<double>(static_cast<std::uint64_t>(bias + exponent) << mantissa);
        };
        const double up = power(shift), down = power(-shift);
        bool fits = true;
        for (int i = 0; i < K; ++i) {
            at_[i] = {static_cast<std::int64_t>(points[i].x * up),
                      static_cast<std::int64_t>(points[i].y * up)};
            // What was rounded or too small does not come back.
            fits &= (static_cast<double>(at_[i].x) * down == points[i].x) &
                    (static_cast<double>(at_[i].y) * down == points[i].y);
        }
        fits_ = fits;
    }

    bool fits() const { return fits_; }
    // The coordinates times 2^shift.
    int shift() const { return shift_; }
    Step at(int i) const { return at_[i]; }
    Step step(int from, int to) const { return {at_[to].x - at_[from].x, at_[to].y - at_[from].y}; }

 private:
    bool fits_ = false;
    int shift_ = 0;
    Step at_[K];
};

}  // namespace liftmesh
