// What a surface over the rows answers: heights and slopes at points and as rasters, neighbours,
// lines, rings and volumes.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_surfaces(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
