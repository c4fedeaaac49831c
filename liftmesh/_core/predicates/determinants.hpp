// The determinants of the orientation and the in-circle test themselves, not their signs only: each
// is the exact one, rounded once to 53 bits, for all finite doubles.
//
// Being integers on a lattice, they have no range: a result keeps its exponent apart.
#pragma once

#include <cmath>

#include "base/point.hpp"

namespace liftmesh {

struct Scaled {
    double mantissa = 0;  // 0, or a magnitude in [1/2, 1)
    int exponent = 0;

    static Scaled of(double value, int exponent) {
        int more = 0;
        const double mantissa = std::frexp(value, &more);
        return {mantissa, exponent + more};
    }
};

inline Scaled operator*(Scaled a, Scaled b) {
    return Scaled::of(a.mantissa * b.mantissa, a.exponent + b.exponent);
}
inline Scaled operator/(Scaled a, Scaled b) {
    return Scaled::of(a.mantissa / b.mantissa, a.exponent - b.exponent);
}
inline Scaled operator+(Scaled a, Scaled b) {
    if (a.mantissa == 0) return b;
    if (b.mantissa == 0) return a;
    const int most = a.exponent > b.exponent ? a.exponent : b.exponent;
    return Scaled::of(
        std::ldexp(a.mantissa, a.exponent - most) + std::ldexp(b.mantissa, b.exponent - most),
        most);
}

// (a - c) x (b - c): twice the area of a triangle, its sign that of orient2d().
Scaled turn(Point a, Point b, Point c);

// The determinant whose sign is that of incircle().
Scaled in_circle(Point a, Point b, Point c, Point d);

}  // namespace liftmesh
