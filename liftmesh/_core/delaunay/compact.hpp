// From slots to rows: ghosts are dropped, vertices become rows of the input.
#pragma once

#include "base/result.hpp"
#include "base/status.hpp"
#include "delaunay/divide_conquer.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// The arrays of the construction become those of the result.
Status compact(Construction from, ThreadPool& pool, Result& result);

}  // namespace liftmesh
