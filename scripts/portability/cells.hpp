// Voronoi and power diagrams, their regions, and cells clipped to a square on its corner.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_cells(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
