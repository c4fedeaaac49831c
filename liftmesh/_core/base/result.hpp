// The output arrays: triangles over rows of the input.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/buffer.hpp"

namespace liftmesh {

struct Result {
    Buffer<std::int32_t> simplices, neighbors;  // triangle_count x 3
    Buffer<std::int32_t> hull;                  // hull_count rows, counter-clockwise
    std::size_t triangle_count = 0;
    std::size_t hull_count = 0;

    void make_room(std::size_t triangles, std::size_t hull_vertices) {
        triangle_count = triangles;
        hull_count = hull_vertices;
        simplices = allocate<std::int32_t>(3 * triangles);
        neighbors = allocate<std::int32_t>(3 * triangles);
        hull = allocate<std::int32_t>(hull_vertices);
    }
};

}  // namespace liftmesh
