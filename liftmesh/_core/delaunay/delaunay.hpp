// The whole way from the caller's rows to the caller's arrays.
#pragma once

#include <vector>

#include "base/input.hpp"
#include "base/result.hpp"
#include "base/status.hpp"
#include "delaunay/mesh.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/distinct.hpp"
#include "sorting/order.hpp"

namespace liftmesh {

// Edges are named by 32 bits, fewer than 2 n triangles take six names each.
inline constexpr std::size_t most_rows = ~std::uint32_t{0} / (2 * words_per_triangle);

struct Delaunay {
    Status status = Status::ok;
    std::size_t row = 0;       // the first non-finite row, where that is the status
    std::size_t distinct = 0;  // how many positions there are
    std::vector<Duplicate> duplicates;
    std::vector<Row> skipped;
    Result result;
};

// What every engine begins with: the distinct points are arranged, and what is known of them by
// then is in the outcome. There is work left where its status is ok.
Delaunay start(const Input& input, bool skip_non_finite, ThreadPool& pool, Order& order);

// The same for engines that need one thread from then on.
Delaunay start(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt,
               Order& order);

// By divide and conquer.
Delaunay delaunay(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
