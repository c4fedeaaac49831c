// Exact comparisons of heights on the paraboloid z = |p - q|^2, whose vertex q is any finite point.
//
// Only the paper's first edge needs them: everywhere else q cancels.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// The sign of z_a - z_b.
int compare_heights(Point a, Point b, Point q);

// The sign of (b_y - a_y) (z_c - z_a) - (c_y - a_y) (z_b - z_a): which way the projections of the
// lifted a, b, c onto the plane Oyz turn, y to the right and z upwards.
int turn_in_oyz(Point a, Point b, Point c, Point q);

}  // namespace liftmesh
