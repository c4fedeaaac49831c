// Exact determinants as numbers, rounded once, with the weights, slopes and comparisons of heights
// that are computed from them.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// The determinants of the orientation and the in-circle test themselves, not their signs only: each
// is the exact one, rounded once to 53 bits, for all finite doubles. Being integers on a lattice,
// they have no range: a result keeps its exponent apart.
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

// On the paraboloid z = |p - q|^2, whose vertex q is any finite point. Only the paper's first edge
// needs it: everywhere else q cancels.

// The sign of (b_y - a_y) (z_c - z_a) - (c_y - a_y) (z_b - z_a): which way the projections of the
// lifted a, b, c onto the plane Oyz turn, y to the right and z upwards.
int turn_in_oyz(Point a, Point b, Point c, Point q);

// Quotients of exact determinants, which have an error of a few units in the last place whatever
// the shape and the size of a triangle: for those so thin, small or large that rounded determinants
// do not do.

// The weights of b and c; that of a is what is missing to 1.
struct Weights {
    double of_b, of_c;
};

Weights exact_weights(Point a, Point b, Point c, Point query);

// Of the plane through three points with heights: dz/dx and dz/dy. Each is the quotient of two
// determinants: of z and y, or x and z, and of x and y.
Point exact_slopes(const Point (&corners)[3], const double (&heights)[3]);

}  // namespace liftmesh
