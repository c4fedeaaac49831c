// From slots to the caller's arrays: ghosts dropped, vertices named by their rows.
#pragma once

#include "base/result.hpp"
#include "base/status.hpp"
#include "delaunay/divide_conquer.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// `left` is memory that the result may take over.
Status emit(const Construction& from, ThreadPool& pool, Memory left, Result& result);

}  // namespace liftmesh
