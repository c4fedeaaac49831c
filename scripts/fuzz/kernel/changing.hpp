// What holds of a triangulation that takes points in and out, at every moment.
#pragma once

#include "dynamic/triangulation.hpp"

namespace fuzzing {

// The triangles are those of a fresh run on the points and constraints present, as sets of
// positions, and the pieces of constraints are the same.
void compare_with_fresh(const liftmesh::dynamic::Triangulation& mesh);

// Triangles, neighbours and hull are in order, and every edge is canonical.
void judge(const liftmesh::dynamic::Triangulation& mesh);

}  // namespace fuzzing
