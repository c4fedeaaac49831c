// Pairs of points whose circles of influence meet, found in a tree of boxes that know the greatest
// radius in them. There are at most 17.5 such pairs a point (T. S. Michael and T. Quint, 1994), but
// they need not be edges of a Delaunay triangulation.
#pragma once

#include "base/status.hpp"
#include "proximity/relative.hpp"

namespace liftmesh {

bool find_influence(const Sides& sides, Interrupt& interrupt, Edges& edges);

}  // namespace liftmesh
