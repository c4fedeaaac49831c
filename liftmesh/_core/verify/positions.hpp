// Rows at one position.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"
#include "verify/subject.hpp"

namespace liftmesh {

// Whether a row is a corner: a byte for each.
using Marks = std::vector<std::uint8_t>;

// Adds every finite row that has no vertex at its position. False where the interrupt came first.
bool find_missing(const Subject& subject, const Marks& vertices, ThreadPool& pool, Flaws& flaws);

// The lowest row at the position of each finite row. False where the interrupt came first.
bool find_lowest(const Subject& subject, ThreadPool& pool, std::vector<Row>& lowest);

}  // namespace liftmesh
