// The paper's procedures as engines: planar points are lifted and wrapped facet by facet.
#pragma once

#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/delaunay.hpp"
#include "paper/counts.hpp"

namespace liftmesh {

enum class Procedure : std::uint8_t { lf, lfres, lfres_indexed };

// The Delaunay triangulation by Algorithm 2. `q` is the vertex of the paraboloid.
Delaunay wrap_delaunay(const Input& input, bool skip_non_finite, Procedure procedure, Point q,
                       Threads threads, Interrupt& interrupt, paper::Counts& counts);

}  // namespace liftmesh
