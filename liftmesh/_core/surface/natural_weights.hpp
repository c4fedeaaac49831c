// Natural neighbours and Sibson's weights of many points, without heights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "delaunay/query_order.hpp"
#include "delaunay/triangulated.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

struct NaturalWeights {
    std::vector<std::int64_t> starts;  // one more than points
    std::vector<std::int32_t> rows;    // in ascending order for each point
    std::vector<double> weights;       // those of a point add up to 1
    bool is_sound = true;              // rows that were written meanwhile have not been noticed
};

// At a vertex this alone, on a side of the hull its two ends, linearly; nothing outside.
// `simplices` has the triangle of each query, or -1. False if the interrupt came first.
bool natural_weights(const Triangulated& mesh, const Queries& queries,
                     const std::int32_t* simplices, NaturalWeights& found, Threads threads,
                     Interrupt& interrupt);

}  // namespace liftmesh
