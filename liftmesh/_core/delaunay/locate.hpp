// Point location in a finished Delaunay triangulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/input.hpp"
#include "base/status.hpp"
#include "sorting/splitters.hpp"

namespace liftmesh {

// The caller's triangulation, read in place.
struct Triangulated {
    Input points;
    const std::int32_t* simplices;  // count x 3, counter-clockwise
    const std::int32_t* neighbors;  // count x 3; entry k is opposite vertex k; -1 outside
    std::size_t count;
};

class Locator {
 public:
    explicit Locator(const Triangulated& triangulated);

    // The smallest simplex whose closed triangle contains the point; -1 outside the hull, for
    // points that are not finite, and if patience ends.
    std::int32_t find(Point p, Patience& patience) const;

 private:
    struct Found {
        std::int32_t simplex;  // -1 if the point is outside
        int turn[3];           // the sign of orient2d for each edge and the point
    };

    std::int32_t vertex(std::int32_t simplex, int k) const {
        return triangulated_.simplices[3 * static_cast<std::ptrdiff_t>(simplex) + k];
    }
    Point corner(std::int32_t simplex, int k) const {
        return triangulated_.points[static_cast<std::size_t>(vertex(simplex, k))];
    }
    std::int32_t neighbor(std::int32_t simplex, int k) const {
        return triangulated_.neighbors[3 * static_cast<std::ptrdiff_t>(simplex) + k];
    }
    Found walk(Point p, Patience& patience) const;
    std::int32_t smallest_around(std::int32_t simplex, int k, Patience& patience) const;

    Triangulated triangulated_;
    Splitters splitters_;
    std::vector<std::int32_t> start_;  // a simplex for each cell
};

}  // namespace liftmesh
