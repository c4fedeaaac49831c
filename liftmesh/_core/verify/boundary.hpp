// Whether the boundary of the triangles is one closed convex curve that winds around once.
#pragma once

#include <cstddef>
#include <vector>

#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"
#include "verify/mesh_view.hpp"

namespace liftmesh {

struct Boundary {
    Flaws flaws;
    std::size_t uncovered = 0;  // vertices at which no triangle covers the direction upwards
};

// Checks half-edges without a twin. False if the interrupt came first.
bool check_boundary(const MeshView& mesh, const std::vector<HalfEdge>& edges, ThreadPool& pool,
                    Boundary& boundary);

}  // namespace liftmesh
