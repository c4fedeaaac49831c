// Reorders triangles so that neighbours in the plane are close in memory.
#pragma once

#include <cstdint>

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/mesh_view.hpp"

namespace liftmesh {

struct Gathered {
    Buffer<std::int32_t> simplices;  // count x 3
    Buffer<std::uint32_t> order;     // the number of each in the mesh
};

// Leaves `gathered` empty if the triangles are few, or in such an order already. All corners must
// be rows. False if the interrupt came first.
bool gather(const MeshView& mesh, ThreadPool& pool, Gathered& gathered);

}  // namespace liftmesh
