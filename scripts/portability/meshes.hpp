// Triangulations, by each engine that is quick enough, what is found in them, and their check.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_meshes(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
