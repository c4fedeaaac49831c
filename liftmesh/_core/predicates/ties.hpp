// The rule for ties: where a lifted point is exactly on the plane of three others.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// The sign that incircle(a, b, c, d), or orient3d, has once lexicographically larger points (by x,
// then y) are lifted infinitely little more. It is 0 only where a, b, c are on one line, or d has
// the position of one of them.
int sign_of_tie(Point a, Point b, Point c, Point d);

}  // namespace liftmesh
