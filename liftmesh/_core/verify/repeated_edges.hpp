// Edges with several triangles on one side.
#pragma once

#include "parallel/thread_pool.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/flaws.hpp"
#include "verify/mesh_view.hpp"
#include "verify/positions.hpp"

namespace liftmesh {

// Adds those edges to `flaws`, and removes them from `pairing.flippable`: which of their half-edges
// are twins is undecidable. What is left does not depend on the order of the triangles. False if
// the interrupt came first.
bool separate_repeated(const MeshView& mesh, const Marks& corners, ThreadPool& pool,
                       EdgePairing& pairing, Flaws& flaws);

}  // namespace liftmesh
