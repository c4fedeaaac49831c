// Exact signs, and the numbers of the filters before them, of rows that follow one another.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_signs(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
