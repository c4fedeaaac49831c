// Divide and conquer on the lifted lower hull, for every lift, from sorted points to a
// construction; and its conversion to the result (`compact`).
#pragma once

#include "base/buffer.hpp"
#include "base/facets.hpp"
#include "base/status.hpp"
#include "delaunay/merge.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/lift.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

// A triangulation in progress or complete: the points in their final order, and the slots of the
// triangles. Each site of the order takes as much room as the vertices of its two slots, so these
// are written over the sites that have moved to their final places.
struct Construction {
    Buffer<Point> points;
    Buffer<Row> rows;
    Buffer<Vertex> vertices;  // of 2 * count - 2 triangles, ghosts included
    Buffer<Edge> twins;
    std::size_t count = 0;
    std::size_t dead = 0;  // slots without a triangle, marked as ghosts are
    TriangleId some_ghost = 0;
    std::uint8_t* marks = nullptr;  // one of each slot, which go with the triangles, if any
};

// Takes the memory of the sites, and makes that of the result.
void make_room(Order& order, Construction& result);

// Triangulates the distinct points of `order` (at least two), lifted by what hides none of them,
// and takes the memory of its sites. The guard vouches for the heights as well.
template <class Lift>
Status divide_and_conquer(const Lift& lift, Guard guard, Order& order, ThreadPool& pool,
                          Construction& result);

// Divide and conquer for sites of a value: regular triangulations.

// Triangulates the distinct points of `order` (at least two), each with the value of its row. Takes
// the memory of the sites. Sites that the result has no triangle of are hidden.
template <class Lift>
Status divide_and_conquer(const Lift& lift, const typename Lift::Value* value_of_row, Order& order,
                          ThreadPool& pool, Construction& result);

// From slots to rows: ghosts are dropped, vertices become rows of the input.

// The arrays of the construction become those of the result.
Status compact(Construction from, ThreadPool& pool, Result& result);

}  // namespace liftmesh
