// A hash of positions.
#pragma once

#include <bit>
#include <cstdint>

#include "base/point.hpp"

namespace liftmesh {

// The top bits of a sum of products depend on every bit of both coordinates: lattice points differ
// in few bits, mostly the highest.
inline std::uint64_t hash(Point p) {
    return std::bit_cast<std::uint64_t>(p.x) * 0x9e3779b97f4a7c15u +
           std::bit_cast<std::uint64_t>(p.y) * 0xd1b54a32d192ed03u;
}

}  // namespace liftmesh
