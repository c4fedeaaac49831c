// Which triangles of a merge lie on ground that a child has finished.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.hpp"
#include "tiles/frontier.hpp"

namespace liftmesh {

enum class Ground : std::uint8_t { open, settled, filler };

// Marks as filler what is on the left of the rim, up to the rim. Returns how many edges of the rim
// are edges of no triangle: none, if the rim is that of the points.
std::size_t mark_filler(const Result& mesh, std::size_t points, std::span<const RimEdge> rim,
                        Ground* ground);

}  // namespace liftmesh
