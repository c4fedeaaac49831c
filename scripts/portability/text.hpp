// Numbers printed, and parsed from text.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

// Coordinates, their bits as whole numbers, and as single precision; what is printed is parsed.
void add_printed(const double* coordinates, std::size_t rows, Digests& digests);

// The lines of a file, one number each.
void add_parsed(const char* file, Digests& digests);

}  // namespace portability
