// Pairs of points whose circles of influence meet: at most 17.5 a point (T. S. Michael and T.
// Quint, 1994), but not all are edges of a Delaunay triangulation.
//
// Each circle is compared with those that are not larger, which are in trees of boxes, one for each
// power of two of the radii. A box is ruled out if all of it is further from the centre than the
// circle and the largest radius of its tree reach. Of a box far away, whose distance is rounded,
// the difference to the radius is computed from places near the point that the circle goes through:
// so the time is near-linear for circles of all sizes.
#pragma once

#include "base/status.hpp"
#include "proximity/relative.hpp"

namespace liftmesh {

bool find_influence(const EdgeSides& sides, Interrupt& interrupt, Edges& edges);

}  // namespace liftmesh
