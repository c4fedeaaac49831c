// Whether given tetrahedra are the Delaunay triangulation of points in space.
//
// 1. Every tetrahedron is positive, every facet has at most one on either side.
// 2. The facets with one alone, the boundary, are the surface of a convex polyhedron: each edge of
//    it is in two of them, once in each direction. No corner of the first tetrahedron is outside of
//    any, so the point o in its middle is strictly inside of all: seen from o the boundary covers
//    the sphere of directions some k times. No two of them that share an edge make a valley. At the
//    lexicographically largest vertex u the facets are one cycle that turns around once. As u is
//    extreme, no other facet meets the ray from o through u behind u, and as u is outside of none,
//    none does before: so k is 1, the boundary is embedded, and locally convex, so convex
//    (H. Tietze, 1928; S. Nakajima, 1928).
// 3. So a point is in as many tetrahedra as the boundary winds around it: those of the hull in one,
//    others in none. Each position of a row is a vertex.
// 4. No sphere contains the opposite vertex of a neighbour: then none contains any (B. Delaunay,
//    1934).
#pragma once

#include "base/input.hpp"
#include "verify/simplices.hpp"

namespace liftmesh {

// Simplices are count x 4. Places are facets 4 t + k, opposite corner k of tetrahedron t, if
// nothing else is said.
SpaceVerdict verify_tetrahedra(const Input& input, const std::int32_t* simplices, std::size_t count,
                               bool skip_non_finite, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
