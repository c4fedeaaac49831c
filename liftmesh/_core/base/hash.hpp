// Hashes by multiplication (Knuth, "The Art of Computer Programming", volume 3, 6.4): their top
// bits depend on all that is hashed.
#pragma once

#include <bit>
#include <cstdint>

#include "base/point.hpp"

namespace liftmesh {

// Of 2^64, and odd: its multiples are evenly spread.
inline constexpr std::uint64_t golden_section = 0x9e3779b97f4a7c15u;

inline std::uint64_t hash(std::uint64_t key) {
    return key * golden_section;
}

// Lattice points differ in few bits, mostly the highest.
inline std::uint64_t hash(Point p) {
    return hash(std::bit_cast<std::uint64_t>(p.x)) +
           std::bit_cast<std::uint64_t>(p.y) * 0xd1b54a32d192ed03u;
}

}  // namespace liftmesh
