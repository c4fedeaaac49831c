// From slots to the caller's arrays: ghosts dropped, vertices named by their rows.
#pragma once

#include "divide_conquer.hpp"
#include "result.hpp"
#include "status.hpp"
#include "team.hpp"

namespace liftmesh {

// `left` is memory that the result may take over.
Status emit(const Construction& from, Team& team, Memory left, Result& result);

}  // namespace liftmesh
