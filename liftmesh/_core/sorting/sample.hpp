// The places of a sample.
#pragma once

#include <cstddef>
#include <cstdint>

namespace liftmesh {

// The i-th place of a sample among `count`: a Weyl sequence, evenly spread and not aligned with any
// raster.
inline std::size_t sample_place(std::size_t i, std::size_t count) {
    const std::uint64_t turned = (i + 1) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(((turned >> 32) * count) >> 32);
}

}  // namespace liftmesh
