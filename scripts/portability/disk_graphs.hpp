// Graphs of disks with their circles, and stars in metrics of their own.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

void add_disks(const double* coordinates, std::size_t rows, Digests& digests);

}  // namespace portability
