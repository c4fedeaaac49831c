// Where edges cross, each coordinate the double nearest to the exact one, and how far points are
// from the lines of edges.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// Of each pair of edges, eight numbers, x and y: NaN where double words are far from telling, as of
// edges that are nearly parallel, and for coordinates beyond 2^200 or so near to zero.
void find_crossings(const double* pairs, std::size_t count, double* places);

// One pair, in IEEE arithmetic, and what rounding has taken away.
struct EdgeCrossing {
    Point place, residual;
};
EdgeCrossing crossing_of(const double* pair);

// Of each edge and point, six numbers: the distance, within a few units in the last place.
void find_distances(const double* edges_and_points, std::size_t count, double* distances);

}  // namespace liftmesh
