// Doubles as integers on a common lattice 2^low.
//
// A finite double is mantissa * 2^exponent. Among the coordinates of one predicate call let `low`
// be the least exponent in use and `width` the bits from there to the top of the largest: then each
// coordinate is an integer of at most `width` bits, and each difference one of `width` + 1.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "point.hpp"
#include "predicates/wide.hpp"

namespace liftmesh {

struct Dyadic {
    std::int64_t mantissa;  // odd, or zero
    int exponent;
};

inline Dyadic dyadic(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const int biased = static_cast<int>(bits >> 52) & 0x7ff;
    std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52) - 1);
    if (biased != 0) mantissa |= std::uint64_t{1} << 52;
    if (mantissa == 0) return {0, 0};
    const int trailing = std::countr_zero(mantissa);
    const auto odd = static_cast<std::int64_t>(mantissa >> trailing);
    return {bits >> 63 ? -odd : odd, std::max(biased, 1) - 1075 + trailing};
}

inline int bit_length(std::int64_t value) {
    return 64 - std::countl_zero(static_cast<std::uint64_t>(value < 0 ? -value : value));
}

// The coordinates of K points on their common lattice.
template <int K>
class Lattice {
 public:
    explicit Lattice(const Point (&points)[K]) {
        int low = std::numeric_limits<int>::max();
        int high = std::numeric_limits<int>::min();
        for (int i = 0; i < K; ++i) {
            x_[i] = dyadic(points[i].x);
            y_[i] = dyadic(points[i].y);
            for (const Dyadic& part : {x_[i], y_[i]}) {
                if (part.mantissa == 0) continue;
                low = std::min(low, part.exponent);
                high = std::max(high, part.exponent + bit_length(part.mantissa));
            }
        }
        low_ = low;
        width_ = high > low ? high - low : 0;
    }

    // Whether differences fit Wide<N> with two bits to spare, which is what the polynomials need.
    template <int N>
    bool fits() const {
        return width_ + 1 <= 64 * N - 2;
    }

    template <int N>
    Wide<N> x(int i) const {
        return place<N>(x_[i]);
    }
    template <int N>
    Wide<N> y(int i) const {
        return place<N>(y_[i]);
    }

 private:
    template <int N>
    Wide<N> place(Dyadic part) const {
        return shifted<N>(part.mantissa, part.mantissa == 0 ? 0 : part.exponent - low_);
    }

    Dyadic x_[K], y_[K];
    int low_, width_;
};

}  // namespace liftmesh
