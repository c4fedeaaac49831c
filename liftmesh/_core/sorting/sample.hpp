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

// A biased random order of insertion (N. Amenta, S. Choi and G. Rote, "Incremental constructions
// con BRIO", 2003): each of its rounds has about 2^`bits` - 1 times as many as all before it, and
// keeps their order. The rounds come from trailing zeros of random numbers, with the secret as
// their seed.
inline std::vector<Vertex> biased_random_order(std::size_t count, int bits, std::uint64_t secret) {
    std::array<std::vector<Vertex>, 65> rounds;
    for (std::size_t v = 0; v < count; ++v) {
        const int round = std::countr_zero(random_number(v, secret)) / bits;
        rounds[static_cast<std::size_t>(round)].push_back(static_cast<Vertex>(v));
    }
    std::vector<Vertex> order;
    order.reserve(count);
    for (auto round = rounds.rbegin(); round != rounds.rend(); ++round) {
        order.insert(order.end(), round->begin(), round->end());
        *round = {};
    }
    return order;
}

}  // namespace liftmesh
