// From slots to the output arrays: ghosts are dropped, vertices become rows.
#pragma once

#include "base/result.hpp"
#include "base/status.hpp"
#include "delaunay/divide_conquer.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// The result may take over the memory `left`.
Status emit(const Construction& from, ThreadPool& pool, Memory left, Result& result);

}  // namespace liftmesh
