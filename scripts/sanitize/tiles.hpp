// Tiles and their merges, on several threads.
#pragma once

#include <cstddef>

#include "clouds.hpp"

namespace parallel {

// Triangulates a cloud in two tiles, on one thread and on several, and interrupts some runs. Ends
// the process if anything differs, or if there are not as many triangles as one run makes.
void check_tiles(const Cloud& cloud, std::size_t triangles);

}  // namespace parallel
