// Cuts inside a cell: a few points are halved by their ranks, more of them near their middle, in
// one pass without jumps, by a pivot taken from nine of them.
#pragma once

#include <cstddef>

#include "site.hpp"

namespace liftmesh {

// Reorders `count` >= 4 sites of distinct positions and returns the middle: every site before it
// precedes across `axis` every site from it on. At least two stand on each side.
std::size_t halve(Site* sites, std::size_t count, Axis axis);

}  // namespace liftmesh
