// The least and the greatest height of the faces that are left.
#pragma once

#include <limits>

#include "parallel/thread_pool.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

struct HeightRange {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
};

// NaN if a height is not finite; from infinity to -infinity if there is no face. False if the
// interrupt came first.
bool height_range(const Relief& relief, HeightRange& found, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
