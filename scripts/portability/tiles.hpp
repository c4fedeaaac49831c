// The nodes of a tiled triangulation, and what their faces reach.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_tiles(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
