// The centre of the sphere through the corners of a tetrahedron in space, correctly rounded.
#pragma once

#include "predicates/orient3d.hpp"

namespace liftmesh {

// Each coordinate is the nearest double, infinite where that would be, and never -0. The corners
// are finite and span space, in any order.
SpacePoint circumcentre(const std::array<SpacePoint, 4>& corners);

}  // namespace liftmesh
