// The predicates by their definitions, in integers of any length.
//
// incircle and orient3d are the sign of the determinant with the rows (x, y, z, 1), expanded along
// z; the symbolic perturbation is applied as such: the first of its terms that is not zero decides.
#pragma once

#include <array>
#include <cstdint>

#include "base/point.hpp"
#include "predicates/orient3d.hpp"

namespace fuzzing {

using liftmesh::Point;
using liftmesh::SpacePoint;

// +1 if a, b, c are counter-clockwise, -1 if clockwise, 0 if collinear.
int turn(Point a, Point b, Point c);

// +1 if the lift of d, or d itself, is below the plane through counter-clockwise a, b, c.
// `canonical` applies the perturbation, for distinct positions.
int incircle(Point a, Point b, Point c, Point d, bool canonical);
int orient3d(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d, bool canonical);

// +1 if e is inside the sphere through a, b, c, d that turn as positive tetrahedra do, -1 for those
// that turn the other way; `canonical` lifts lexicographically larger points more.
int insphere(const SpacePoint (&points)[5], bool canonical);

// By what points are lifted: see predicates/lift.hpp.
enum class Lift : std::uint8_t { weights, radii, metric, farthest };

// a, b and c of the metric.
inline constexpr int form[] = {5, -2, 3};

// The same as incircle for lifted points; values are weights or radii.
int lifted_side(Lift lift, const std::array<Point, 4>& corners, const std::array<double, 4>& values,
                bool canonical);

// Whether d is further than a distance from the plane through counter-clockwise a, b, c, along z.
bool exceeds(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d, double distance);

// As in predicates/distances.hpp.
int compare_distances(Point a, Point b, Point c, Point d);
int sign_at_apex(Point a, Point b, Point c);
bool do_circles_cross(Point a, Point p, Point b, Point q);

// As in predicates/determinants.hpp.
int turn_in_oyz(Point a, Point b, Point c, Point q);

}  // namespace fuzzing
