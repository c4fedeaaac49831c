// The test of one edge of a graph of disks: whether the arc that is its dual leads forward.
#pragma once

#include "apollonius/disk.hpp"

namespace liftmesh {

enum class DiskEdge : std::uint8_t {
    right,
    tied,      // right for the disks as they are, but the rule for ties chooses another one
    entered,   // a disk beside it enters the circle at its other end
    backwards  // its arc leads from the circle on the left to that on the right
};

// Of the edge from p to q, with r on its left and s on its right. Of p, q, r and of q, p, s, none
// is in another, and both have a circle.
DiskEdge judge(const apollonius::Signs& signs, const apollonius::Disk& p, const apollonius::Disk& q,
               const apollonius::Disk& r, const apollonius::Disk& s);

// Whether the arc at infinity of the edge from p to infinity, with r on its left and s on its
// right, holds the direction right after that of the x-axis. The edge is right, or tied.
bool holds_x_axis(const apollonius::Signs& signs, const apollonius::Disk& p,
                  const apollonius::Disk& r, const apollonius::Disk& s);

}  // namespace liftmesh
