// The vertex nearest to a point, by a walk on the Delaunay graph.
//
// A vertex that is not the nearest has a neighbour in the graph that is nearer, so going on to
// nearer ones ends at the nearest. That holds for ties as well: of several at one distance the
// lexicographically least counts as nearest, as if the point were moved towards it by
// infinitesimally little. The walk begins at a corner of the triangle that contains the point, and
// mostly ends there. A neighbour is nearer only if its direction is less than a right angle from
// that of the point: so around the first vertex, to both sides of the triangle, others are not
// looked at.
#pragma once

#include <cstdint>

#include "base/point.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

// Of a finite point in a closed triangle. -1 if it takes more than some steps, as around vertices
// of many triangles, or if rows were written meanwhile and this was noticed.
std::int32_t nearest_vertex(const Triangulated& mesh, Point query, std::int32_t simplex);

// Whether p is nearer to the point than q, or at the same distance and lexicographically less.
bool is_nearer(Point p, Point q, Point query);

}  // namespace liftmesh
