// Two doubles that are computed with side by side, mostly the coordinates of a point. This is all
// of the kernel's vector code: a vector type of the compiler, in registers that any processor has.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

using Pair = double __attribute__((vector_size(16)));
using PairBits = long long __attribute__((vector_size(16)));

inline Pair pair(Point p) {
    return Pair{p.x, p.y};
}
inline Pair pair(const Point* p) {
    Pair loaded;
    static_assert(sizeof loaded == sizeof *p);
    std::memcpy(&loaded, p, sizeof loaded);
    return loaded;
}
// To two places, the one after the other.
inline void store(Pair p, double* to) {
    std::memcpy(to, &p, sizeof p);
}
inline void store(Pair p, float* to) {
    using Singles = float __attribute__((vector_size(8)));
    const auto rounded = __builtin_convertvector(p, Singles);
    std::memcpy(to, &rounded, sizeof rounded);
}
// Two integers side by side.
using Ints = std::int32_t __attribute__((vector_size(8)));

inline Ints truncated(Pair p) {
    return __builtin_convertvector(p, Ints);
}
inline Ints both(std::int32_t value) {
    return Ints{value, value};
}
inline void store(Ints p, std::int32_t* to) {
    std::memcpy(to, &p, sizeof p);
}
inline Point point(Pair p) {
    return {p[0], p[1]};
}
// A value as it is, or in both places.
template <class Real>
constexpr Real spread(double value) {
    if constexpr (std::is_same_v<Real, Pair>)
        return Pair{value, value};
    else
        return value;
}
inline Pair swapped(Pair p) {
    return Pair{p[1], p[0]};
}

inline Pair least(Pair p, Pair q) {
    return p < q ? p : q;
}
inline Pair greatest(Pair p, Pair q) {
    return p > q ? p : q;
}
inline Pair magnitudes(Pair p) {
    constexpr long long all_but_sign = 0x7fffffffffffffff;
    return reinterpret_cast<Pair>(reinterpret_cast<PairBits>(p) &
                                  PairBits{all_but_sign, all_but_sign});
}
inline double magnitudes(double a) {
    return std::fabs(a);
}

inline bool are_equal(double a, double b) {
    return a == b;
}
inline bool are_equal(Pair p, Pair q) {
    const PairBits equal = p == q;
    return (equal[0] & equal[1]) != 0;
}

inline bool is_finite(Pair p) {
    constexpr double most = std::numeric_limits<double>::max();
    const PairBits finite = magnitudes(p) <= Pair{most, most};
    return (finite[0] & finite[1]) != 0;
}

// The bounding box of points.

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
