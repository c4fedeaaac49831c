// The rings of a domain, cut into passages through cells.
#pragma once

#include <cstdint>
#include <vector>

#include "cells/clip.hpp"

namespace liftmesh {

struct CrossedRidge {
    std::int32_t edge = -1;  // none: the passage is a whole ring
    std::int32_t row = -1;   // the cell on the other side of the ridge
    Point at = {};
    bool is_certain = false;
};

struct Passage {
    std::int32_t cell, ring;
    std::int32_t first, count;  // corners passed, in a circle
    CrossedRidge in, out;

    bool is_ring() const { return out.edge < 0; }
};

// The rows must be those of the triangles: if the walk along a ring does not end where it began,
// the outcome is `not_simple`.
Clipping find_passages(const Dual& dual, const Spokes& spokes, const Domain& domain,
                       Interrupt& interrupt, std::vector<Passage>& found, std::vector<Tie>& ties);

}  // namespace liftmesh
