// Points that come and go, and terrains of few triangles.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_changes(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
