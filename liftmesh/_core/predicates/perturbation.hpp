// The symbolic perturbation, which is the rule for ties: the sign where a lifted point lies exactly
// on the plane of three others. incircle, orient3d and verify use it; the paper's first edge, which
// compares heights, has the same rule in a form of its own (paper/first_edge.hpp).
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// The sign of incircle(a, b, c, d), or of orient3d, once lexicographically larger points (by x,
// then y) are lifted by an infinitesimal more. It is 0 only if a, b, c are collinear or d coincides
// with one of them.
int perturbed_sign(Point a, Point b, Point c, Point d);

}  // namespace liftmesh
