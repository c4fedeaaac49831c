// A lifted point seen along a lifted base edge a -> b.
//
// Shear the paraboloid, which moves no facet, until both ends of the base lie at height 0: the lift
// of p is then at the height (p - a)(p - b), and its distance from the base, counted in lengths of
// the base and positive on the left, is (b - a) x (p - a). A plane through the base rises by height
// over distance. So the lift of d is below the plane through the base and the lift of c where
//     height(c) distance(d) - height(d) distance(c) > 0    for c on the left,
// which is the in-circle determinant of a, b, c, d: one multiplication for each pair, once both
// points are sighted.
//
// Rounding, with e = 2^-53: the distance and the height are off by at most (1 + e)^4 - 1 of the
// sums of magnitudes of which they are made, the determinant by at most (1 + e)^10 - 1 of its own.
// `bound` holds these sums as computed, at least (1 - e)^4 of the true ones. So 4 e + 26 e^2 and 10
// e + 155 e^2 of what is computed suffice. Where `Guard` vouches for the coordinates a distance or
// a height is 0 or at least 2^-436, and nothing underflows.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// Two doubles that are computed with side by side: any processor has registers for them.
using Pair = double __attribute__((vector_size(16)));
using PairBits = long long __attribute__((vector_size(16)));

inline Pair magnitudes(Pair p) {
    constexpr long long all_but_sign = 0x7fffffffffffffff;
    return reinterpret_cast<Pair>(reinterpret_cast<PairBits>(p) &
                                  PairBits{all_but_sign, all_but_sign});
}

struct Sighting {
    Pair place;  // distance, height
    Pair bound;  // the sums of magnitudes of which they are made
};

class Base {
 public:
    Base(Point a, Point b) : a_{a.x, a.y}, b_{b.x, b.y}, across_{a.y - b.y, b.x - a.x} {}

    Sighting sight(Point p) const {
        const Pair at{p.x, p.y};
        const Pair from_a = at - a_;
        const Pair distance = across_ * from_a;
        const Pair height = from_a * (at - b_);
        const Pair first{distance[0], height[0]};
        const Pair second{distance[1], height[1]};
        return {first + second, magnitudes(first) + magnitudes(second)};
    }

 private:
    Pair a_, b_, across_;
};

// A value whose sign is certain where its magnitude is larger than the error.
struct Margin {
    double value, error;
};

// Positive where the point lies on the left of the base.
inline Margin distance(const Sighting& p) {
    constexpr double e = 0x1p-53;
    constexpr double bound = (4 + 32 * e) * e;
    return {p.place[0], bound * p.bound[0]};
}

// Positive where the lift of d is below the plane through the base and the lift of c.
inline Margin below(const Sighting& c, const Sighting& d) {
    constexpr double e = 0x1p-53;
    constexpr double bound = (10 + 160 * e) * e;
    const Pair value = c.place * Pair{d.place[1], d.place[0]};
    const Pair error = c.bound * Pair{d.bound[1], d.bound[0]};
    return {value[1] - value[0], bound * (error[0] + error[1])};
}

}  // namespace liftmesh
