// Which triangle at a vertex covers the direction upwards.
//
// Upwards means up and, to decide ties, a little to the left: the vertices that come later by x,
// then y, are on the right. So a counter-clockwise triangle covers that direction at its corner b
// where a, b, c is ascending, if it has such a corner.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

inline constexpr int no_corner = 3;

// The corner at which the triangle a, b, c covers the direction, or `no_corner`.
inline int covering_corner(Point a, Point b, Point c) {
    const auto before = [](Point p, Point q) {  // as `before_xy`, without a branch
        return int{p.x < q.x} | (int{p.x == q.x} & int{p.y < q.y});
    };
    constexpr int corner[] = {no_corner, no_corner, no_corner, 1, no_corner, 0, 2, no_corner};
    return corner[before(a, b) | before(b, c) << 1 | before(c, a) << 2];
}

}  // namespace liftmesh
