// Is it the Delaunay triangulation? Asked of anybody's triangles.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/input.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"

namespace liftmesh {

struct Verdict {
    Status status = Status::ok;
    std::size_t row = 0;       // the first non-finite row, where that is the status
    std::size_t skipped = 0;   // rows that are not finite
    std::size_t vertices = 0;  // positions that are corners
    std::size_t merged = 0;    // rows that are corners, beyond one for each position
    std::size_t inner = 0;     // edges between two triangles
    std::size_t border = 0;    // sides of one triangle only
    Flaws flaws;               // of sides only where all corners are rows, and finite
};

// Of count x 3 corners.
Verdict verify(const Input& input, const std::int32_t* simplices, std::size_t count,
               bool skip_non_finite, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
