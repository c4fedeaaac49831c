// What makes triangles the canonical Delaunay triangulation, or the lower hull, of some rows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/facets.hpp"
#include "case.hpp"

namespace fuzzing {

using Rows = std::vector<liftmesh::Row>;
using Triangle = std::array<std::int32_t, 3>;

// Neighbours are mutual, all triangles are counter-clockwise, their number satisfies Euler's
// relation, the hull is their boundary and convex, and their corners are among `rows`; returns
// those that are.
Rows check_structure(const Case& c, const liftmesh::Result& result, const Rows& rows);

// No circumcircle contains the apex of a neighbour, and the symbolic perturbation decides ties; the
// edges that the bits of each triangle mark are left out.
void check_delaunay(const Case& c, const liftmesh::Result& result,
                    const std::uint8_t* marks = nullptr);

// No row is below a facet.
void check_lower(const Case& c, const liftmesh::Result& result, const Rows& rows);

// Sorted, each with its least row first.
std::vector<Triangle> triangles(const liftmesh::Result& result);

bool same_bits(const liftmesh::Result& a, const liftmesh::Result& b);

}  // namespace fuzzing
