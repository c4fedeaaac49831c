// Pairs the half-edges of the triangles into edges, finds the boundary, and tests whether the edges
// between two triangles are locally Delaunay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"
#include "verify/mesh_view.hpp"

namespace liftmesh {

struct EdgePairing {
    Flaws triangles, edges;          // what is wrong with them
    std::size_t interior_edges = 0;  // between two triangles
    std::vector<HalfEdge> boundary;  // half-edges without a twin
};

// Checks each triangle and pairs its half-edges with those of its neighbours. All corners must be
// rows; triangles with non-finite corners are left out. False if the interrupt came first.
bool pair_edges(const MeshView& mesh, ThreadPool& pool, EdgePairing& pairing);

// Pairs all half-edges by a hash partition, which finds non-manifold edges too: what it finds does
// not depend on the order of the triangles.
bool pair_edges_by_hash(const MeshView& mesh, ThreadPool& pool, EdgePairing& pairing);

}  // namespace liftmesh
