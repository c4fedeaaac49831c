// The default engine: divide and conquer on the lifted lower hull.
#pragma once

#include "base/buffer.hpp"
#include "delaunay/merge.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/order.hpp"

namespace liftmesh {

// A triangulation in progress or complete: the points in their final order, and the slots of the
// triangles.
struct Construction {
    Buffer<Point> points;
    Buffer<Row> rows;
    Buffer<Word> triangles;  // of 2 * count - 2, ghosts included
    std::size_t count = 0;
    TriangleId some_ghost = 0;
};

// Triangulates the distinct points of `order` (at least two), whose sites must not be used
// afterwards.
Status divide_and_conquer(Order& order, ThreadPool& pool, Construction& result);

}  // namespace liftmesh
