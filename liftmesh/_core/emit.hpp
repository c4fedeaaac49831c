// From slots to the caller's arrays: ghosts dropped, vertices named by their rows.
#pragma once

#include <cstddef>
#include <cstdint>

#include "buffer.hpp"
#include "divide_conquer.hpp"
#include "result.hpp"
#include "status.hpp"
#include "team.hpp"

namespace liftmesh {

Status emit(const Construction& from, Team& team, Result& result);

}  // namespace liftmesh
