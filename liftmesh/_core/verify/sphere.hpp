// Whether given triangles are the Delaunay triangulation of points on the sphere.
//
// They are, if they are the surface of the convex hull of the unit vectors: the argument is that of
// verify/tetrahedra.hpp for a boundary.
//
// 1. No triangle has two corners of one direction, so none is flat: no line meets a sphere thrice.
// 2. Each edge is in two triangles, once in each direction.
// 3. Of four vertices on no common circle none is above the plane of any triangle, so the point in
//    their middle is strictly inside of all.
// 4. No apex is above the plane of a neighbour, and the triangles at one vertex turn around once:
//    as each unit vector is extreme, they are the surface of a convex body, once.
// 5. Each direction of a row is a vertex.
//
// Of points on one circle the apex of a neighbour may be where the rule for ties has another edge:
// such triangles are valid, and not canonical. Where all points are on one circle, the hull is
// flat, so signs by the rule stand for all, and the canonical triangles alone are valid.
//
// Rows of one direction are one vertex. Those at one position are told by the sort; others are
// looked for only if something is wrong without.
#pragma once

#include "base/input.hpp"
#include "verify/simplices.hpp"

namespace liftmesh {

// Simplices are count x 3; no row may be zero. Places are edges 3 t + k, opposite corner k of
// triangle t. The verdict has no facets of a hull, and no negative simplices.
SpaceVerdict verify_sphere(const Input& input, const std::int32_t* simplices, std::size_t count,
                           bool skip_non_finite, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
