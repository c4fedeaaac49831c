#include "predicates/orient2d.hpp"

#include "predicates/exact_sum.hpp"
#include "predicates/fixed_point.hpp"
#include "predicates/lattice.hpp"

namespace liftmesh {

namespace {

int sign_of_turn(const FixedPoint<3>& points) {
    const Int128 turn = cross(points.step(0, 1), points.step(0, 2));
    return (turn > 0) - (turn < 0);
}

int sign_of_wide_turn(const PlanarLattice<3>& lattice) {
    ExactSum<2> det(lattice.width());
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        det.add(lattice.part_of_x(i) * lattice.part_of_y(j));
        det.subtract(lattice.part_of_y(i) * lattice.part_of_x(j));
    }
    return det.sign();
}

// Axis-parallel lines, and points that coincide, as a query at a vertex does.
bool are_plainly_collinear(Point a, Point b, Point c) {
    const bool x_ab = a.x == b.x, x_bc = b.x == c.x, y_ab = a.y == b.y, y_bc = b.y == c.y;
    return (x_ab & (x_bc | y_ab)) | (y_bc & (x_bc | y_ab)) | (a == c);
}

// A product with its exponent apart, so that it cannot leave the range of doubles.
struct Product {
    double mantissa;  // of a magnitude in [1/4, 1), or zero
    int exponent;
};

Product product(double u, double v) {
    int of_u, of_v;
    const double m = std::frexp(u, &of_u) * std::frexp(v, &of_v);
    return {m, of_u + of_v};
}

// The filter of orient2d where its products underflow or overflow; 0 where it is inconclusive. A
// difference has a relative error of at most e, a product of differences one below 4 e.
int sign_of_scaled(Point a, Point b, Point c) {
    constexpr double bound = 0x1p-50;
    const double ax = a.x - c.x, ay = a.y - c.y, bx = b.x - c.x, by = b.y - c.y;
    if (!std::isfinite(ax) || !std::isfinite(ay) || !std::isfinite(bx) || !std::isfinite(by))
        return 0;
    const Product left = product(ax, by), right = product(ay, bx);
    if (left.mantissa == 0) return (right.mantissa < 0) - (right.mantissa > 0);
    if (right.mantissa == 0) return (left.mantissa > 0) - (left.mantissa < 0);
    const int higher = std::max(left.exponent, right.exponent);
    const double u = std::ldexp(left.mantissa, left.exponent - higher);
    const double v = std::ldexp(right.mantissa, right.exponent - higher);
    if (std::fabs(u - v) <= bound * (std::fabs(u) + std::fabs(v))) return 0;
    return u > v ? 1 : -1;
}

// Out of line: most exact calls are for points on axis-parallel lines, and need none of its stack.
[[gnu::noinline]] int sign_by_integers(Point a, Point b, Point c) {
    if (const FixedPoint<3> points({a, b, c}); points.fits()) return sign_of_turn(points);
    if (const int sign = sign_of_scaled(a, b, c)) return sign;
    return sign_of_wide_turn(PlanarLattice<3>({a, b, c}));
}

}  // namespace

int orient2d_exact(Point a, Point b, Point c) {
    return are_plainly_collinear(a, b, c) ? 0 : sign_by_integers(a, b, c);
}

}  // namespace liftmesh
