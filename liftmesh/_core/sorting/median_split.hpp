// Cuts inside a cell: a few points are halved by their ranks; more points are partitioned near
// their middle, in one branch-free pass, by a pivot chosen from nine of them. Points that share a
// coordinate stay together where enough is left on the other side.
#pragma once

#include <cstddef>

#include "base/point.hpp"
#include "base/site.hpp"

namespace liftmesh {

struct MedianSplit {
    Axis axis;
    std::size_t middle;
};

// Reorders `count` >= 4 sites of distinct positions: every site before the middle precedes across
// the axis every site from it on. At least two stand on each side. The axis is the one along which
// they spread more, estimated from nine of them.
MedianSplit median_split(Site* sites, std::size_t count);

}  // namespace liftmesh
