// The engine of tetrahedralize(): points go into a triangulation one by one.
//
// Several threads insert at the same time, each the points of a stretch of the Hilbert curve (C.
// Marot, J. Pellerin and J.-F. Remacle, "One machine, one minute, three billion tetrahedra", 2019).
// A tetrahedron is that of a stretch if three of its vertices are in it, a ghost with two. So a
// thread goes across facets whose vertices are all its own, and knows without a look that what is
// there is its own as well: nothing is read that another thread writes. A point whose walk or
// cavity leads elsewhere is put off, to a second pass with other stretches, and at last to one
// thread alone. As the triangulation is unique, it does not depend on any of this.
#pragma once

#include "parallel/thread_pool.hpp"
#include "sorting/space_order.hpp"
#include "tetrahedra/space_mesh.hpp"

namespace liftmesh {

// Four points that span space, as a positive tetrahedron, or as many as there are that span what
// all points are in. They do not depend on the order of insertion.
struct Seed {
    std::array<Vertex, 4> vertex;
    int count = 0;
};
// False if the interrupt came first.
bool find_seed(const SpaceOrder& points, Interrupt& interrupt, Seed& seed);

// Fills an empty mesh; the free slots go to `free`. Of the order, points of one round ascend. False
// if the interrupt came first.
bool insert_points(const SpaceOrder& points, const std::vector<Vertex>& order, const Seed& seed,
                   ThreadPool& pool, SpaceMesh& mesh, std::vector<Word>& free);

}  // namespace liftmesh
