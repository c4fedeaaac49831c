// The places of a sample, and random numbers.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// The i-th place of a sample among `count`: a Weyl sequence, evenly spread and not aligned with any
// raster.
inline std::size_t sample_place(std::size_t i, std::size_t count) {
    const std::uint64_t turned = hash(i + 1);
    return static_cast<std::size_t>(((turned >> 32) * count) >> 32);
}

// The i-th of a sequence of random numbers: splitmix64 (Steele, Lea and Flood, "Fast Splittable
// Pseudorandom Number Generators", 2014).
inline std::uint64_t random_number(std::uint64_t i, std::uint64_t seed) {
    std::uint64_t bits = seed + hash(i + 1);
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

}  // namespace liftmesh
