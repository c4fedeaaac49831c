// What makes triangles the canonical Delaunay triangulation, or the lower hull, of some rows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/result.hpp"
#include "case.hpp"

namespace fuzzing {

using Rows = std::vector<liftmesh::Row>;
using Triangle = std::array<std::int32_t, 3>;

// Neighbours are mutual, all triangles turn counter-clockwise, their number is Euler's, the hull is
// their border and convex, and their corners are among `rows`; returns which of them are.
Rows check_structure(const Case& c, const liftmesh::Result& result, const Rows& rows);

// No triangle's circle holds the far corner of a neighbour, and ties follow the rule.
void check_delaunay(const Case& c, const liftmesh::Result& result);

// No row is below a facet.
void check_lower(const Case& c, const liftmesh::Result& result, const Rows& rows);

// Ascending, each from its least row on.
std::vector<Triangle> triangles(const liftmesh::Result& result);

bool same_bits(const liftmesh::Result& a, const liftmesh::Result& b);

}  // namespace fuzzing
