// The default engine: divide and conquer on the lifted lower hull.
#pragma once

#include "merge.hpp"
#include "order.hpp"

namespace liftmesh {

// Triangulates the distinct points of `order` (two at least), which reach their final order on the
// way, into `triangles`: 2 * count - 2 of them, ghosts included.
Status divide_and_conquer(Order& order, Triangle* triangles, Interrupt& interrupt);

}  // namespace liftmesh
