// Rows that change while they are triangulated, for a sanitizer to watch.
#pragma once

#include <cstddef>

namespace parallel {

// Exits with a message if the result names anything but rows, or is no triangulation.
void check_spoilt_rows(std::size_t rows, unsigned most_threads);

}  // namespace parallel
