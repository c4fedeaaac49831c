// Distances between points of the plane: compared exactly, for all finite doubles, or rounded once.
//
// The filters have room for all rounding: each square of a distance errs by less than 4 units of
// 2^-53, or by what the constant covers where products are too small for that. Where they are
// inconclusive exact integers decide.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

int compare_distances_exact(Point a, Point b, Point c, Point d);
int sign_at_apex_exact(Point a, Point b, Point c);

inline double square_of_distance(Point a, Point b) {
    const double x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y;
}

// The sign of |ab| - |cd|.
inline int compare_distances(Point a, Point b, Point c, Point d) {
    const double first = square_of_distance(a, b), second = square_of_distance(c, d);
    const double difference = first - second, error = 0x1p-50 * (first + second) + 0x1p-1000;
    if (std::fabs(difference) > error) return (difference > 0) - (difference < 0);
    return compare_distances_exact(a, b, c, d);
}

// The sign of (a - c) . (b - c): +1 where c is outside of the circle with the diameter ab, 0 on it.
inline int sign_at_apex(Point a, Point b, Point c) {
    const double x = (a.x - c.x) * (b.x - c.x), y = (a.y - c.y) * (b.y - c.y), product = x + y;
    const double error = 0x1p-50 * (std::fabs(x) + std::fabs(y)) + 0x1p-1000;
    if (std::fabs(product) > error) return (product > 0) - (product < 0);
    return sign_at_apex_exact(a, b, c);
}

// Whether the circles around a through p and around b through q meet in two points, if none is in
// the other: |ab| < |ap| + |bq|.
bool do_circles_cross(Point a, Point p, Point b, Point q);

// The double nearest to |ab|; infinite where that is.
double distance(Point a, Point b);

}  // namespace liftmesh
