// The ridges and regions of Voronoi and power diagrams, from triangles and the vertex of each.
//
// A ridge is dual to an edge between two vertices, or leads from a vertex to infinity. The region
// of a site has as many corners as it has ridges, if infinity counts as one. No coordinate is read.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/buffer.hpp"
#include "base/status.hpp"
#include "cells/diagram.hpp"

namespace liftmesh {

struct Regions {
    // The rows of the two sites of each ridge, and the vertices at its ends: the lesser first. A
    // ray has -1 for its first end; seen from its first site, the second is the next on the hull.
    Buffer<std::int32_t> ridge_sites, ridge_ends;
    std::size_t ridge_count = 0, edges = 0;  // there is room for as many ridges as edges
    // Corners starts[i] to starts[i + 1] are those of region i, counter-clockwise. Unbounded ones
    // come first, and begin with -1. Rows without a region have number -1.
    Buffer<std::int32_t> region_of, starts, corners;
    std::size_t region_count = 0;
};

// False if the interrupt came first.
bool make_regions(const Dual& dual, const std::int32_t* vertex_of, Interrupt& interrupt,
                  Regions& regions);

}  // namespace liftmesh
