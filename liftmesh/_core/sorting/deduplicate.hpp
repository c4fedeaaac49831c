// Exact duplicates: of the rows at one position the lowest is kept.
#pragma once

#include <cstddef>
#include <vector>

#include "base/site.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

struct Duplicate {
    Row row, kept;
};

// Moves the first of each position to the front, in order, and returns how many there are. The
// others come after them, in any order, and are appended to `duplicates`. Rows must ascend among
// equal points, as they do when sites come in the order of their rows.
std::size_t deduplicate(Site* sites, std::size_t count, std::vector<Duplicate>& duplicates);

// Unites the duplicates among so many rows, by ascending row. False if the interrupt came first.
bool unite(const std::vector<std::vector<Duplicate>>& found, std::size_t rows, ThreadPool& pool,
           std::vector<Duplicate>& sorted);

}  // namespace liftmesh
