// The targets other than that of the kernel as a whole: what each makes of the fuzzer's bytes.
#pragma once

#include "bytes.hpp"

namespace fuzzing {

// Points come and go one by one, in batches and in interrupted ones.
void check_sequence(Bytes bytes);

// Edges between rows that a triangulation must have.
void check_constraints(Bytes bytes);

// Domains between edges, refined.
void check_refinement(Bytes bytes);

// Heights, pixels, lines, rings and volumes of a surface.
void check_surface(Bytes bytes);

// Two surfaces laid over each other.
void check_overlay(Bytes bytes);

// Tetrahedra of points in space, location, predicates and the verifier.
void check_space(Bytes bytes);

// Few triangles within a bound, and few vertices that matter most.
void check_simplification(Bytes bytes);

}  // namespace fuzzing
