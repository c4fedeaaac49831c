// The engine of tetrahedralize(): points go into a triangulation one by one.
#pragma once

#include "base/status.hpp"
#include "sorting/space_order.hpp"
#include "tetrahedra/space_mesh.hpp"

namespace liftmesh {

// Four points that span space, as a positive tetrahedron, or as many as there are that span what
// all points are in. They do not depend on the order of insertion.
struct Seed {
    std::array<Vertex, 4> vertex;
    int count = 0;
};
Seed find_seed(const SpaceOrder& points);

// Fills an empty mesh. False if the interrupt came first.
bool insert_points(const SpaceOrder& points, const std::vector<Vertex>& order, const Seed& seed,
                   Interrupt& interrupt, SpaceMesh& mesh);

}  // namespace liftmesh
