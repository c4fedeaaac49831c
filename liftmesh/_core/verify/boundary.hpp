// Whether the boundary of the triangles is one closed convex curve that winds around once.
#pragma once

#include <vector>

#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"
#include "verify/mesh_view.hpp"

namespace liftmesh {

// Adds what is wrong to `flaws`. False if the interrupt came first.
bool check_boundary(const MeshView& mesh, const std::vector<HalfEdge>& boundary, ThreadPool& pool,
                    Flaws& flaws);

}  // namespace liftmesh
