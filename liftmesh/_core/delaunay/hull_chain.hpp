// The lower or the upper edges of the hull, whichever are fewer, from left to right: every vertical
// line through the triangulation meets one of them.
#pragma once

#include <cstdint>
#include <vector>

#include "base/status.hpp"
#include "delaunay/triangulated.hpp"
#include "delaunay/vertical_walk.hpp"

namespace liftmesh {

class HullChain {
 public:
    HullChain(const Triangulated& mesh, Patience& patience);

    // The edge that the vertical line through a point meets; `no_edge` left and right of the hull.
    std::uint32_t at(Point p) const;

    std::size_t size() const { return edges_.size(); }

 private:
    const Triangulated& mesh_;
    std::vector<std::uint32_t> edges_;
};

}  // namespace liftmesh
