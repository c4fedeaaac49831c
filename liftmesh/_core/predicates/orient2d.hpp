// orient2d(a, b, c): +1 where a, b, c turn counter-clockwise, -1 clockwise, 0 on one line.
//
// The filter is Shewchuk's ("Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", 1997): |error| <= (3 + 16e) e (|left| + |right|) with e = 2^-53. An underflow in
// either product adds at most 2^-1074, which the constant 1e-300 covers; an overflow makes every
// comparison fail. Where the filter is inconclusive exact integers decide.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

inline constexpr double orient2d_bound = (3 + 16 * 0x1p-53) * 0x1p-53, orient2d_underflow = 1e-300;

int orient2d_exact(Point a, Point b, Point c);

inline int orient2d(Point a, Point b, Point c) {
    const double left = (a.x - c.x) * (b.y - c.y);
    const double right = (a.y - c.y) * (b.x - c.x);
    const double det = left - right;
    const double error = orient2d_bound * (std::fabs(left) + std::fabs(right)) + orient2d_underflow;
    // No branch depends on the sign, which callers may find hard to predict.
    if (std::fabs(det) > error) return (det > 0) - (det < 0);
    return orient2d_exact(a, b, c);
}

}  // namespace liftmesh
