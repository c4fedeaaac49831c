// The lower hull of points in space: randomised incremental construction with conflict lists.
//
// Every point below the current hull waits at one facet that it is below: the one that contains its
// planar position, or a ghost beyond the planar hull. A point is inserted by removing the facets
// that it is below and joining it to the rim of the hole; points that waited there move to the new
// facets, found by their angle around it, and those that are above stay above for good. Rounds of
// doubling size, in kd order inside a round, keep memory accesses local while the expected number
// of moves stays O(n log n) on every input (N. Amenta, S. Choi and G. Rote, "Incremental
// constructions con BRIO", 2003; K. L. Clarkson and P. W. Shor, 1989).
#pragma once

#include <span>
#include <vector>

#include "base/facets.hpp"
#include "base/status.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient3d.hpp"

namespace liftmesh {

// `points` have distinct planar positions, preferably in an order that keeps neighbours together.
// There are no facets if the positions are collinear.
Status incremental_hull(std::span<const SpacePoint> points, Guard guard, Interrupt& interrupt,
                        std::vector<Facet>& facets);

}  // namespace liftmesh
