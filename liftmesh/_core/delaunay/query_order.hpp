// Queries in spatial order: by the cells of a kd tree, with one parallel counting sort.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/splitters.hpp"

namespace liftmesh {

struct Query {
    std::uint32_t cell, index;
};

struct Queries {
    const double* coordinates;  // count x 2
    std::size_t count;

    Point operator[](std::size_t i) const { return {coordinates[2 * i], coordinates[2 * i + 1]}; }
    [[gnu::always_inline]] void prefetch(std::size_t i) const {
        liftmesh::prefetch(coordinates + 2 * i);
    }
};

// Neighbours in the plane become neighbours in the list. Trees of more than 2^16 cells are sorted
// by the upper splitters, and then in pieces by all of them. Null if the interrupt came first.
Buffer<Query> in_spatial_order(const Queries& queries, const Splitters& splitters,
                               ThreadPool& pool);

}  // namespace liftmesh
