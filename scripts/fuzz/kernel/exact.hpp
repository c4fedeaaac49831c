// The predicates as their definitions have them, in integers of any length.
//
// A side is the determinant of the rows (x, y, z, 1), expanded along z; the rule for ties is the
// perturbation itself: the first of its terms that is not zero.
#pragma once

#include "base/point.hpp"
#include "predicates/orient3d.hpp"

namespace fuzzing {

using liftmesh::Point;
using liftmesh::SpacePoint;

// The sign of the turn from a over b to c.
int turn(Point a, Point b, Point c);

// +1 where the lift of d, or d itself, is below the plane through a, b, c that turn
// counter-clockwise. `canonical` breaks ties of distinct positions.
int side(Point a, Point b, Point c, Point d, bool canonical);
int side(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d, bool canonical);

// As predicates/heights.hpp has them.
int compare_heights(Point a, Point b, Point q);
int turn_in_oyz(Point a, Point b, Point c, Point q);

}  // namespace fuzzing
