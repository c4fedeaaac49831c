// A distinct point of the input and the row that represents it.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

struct Site {
    Point point;
    Row row;
};

}  // namespace liftmesh
