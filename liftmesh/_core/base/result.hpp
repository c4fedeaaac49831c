// The output arrays: triangles over rows of the input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "base/buffer.hpp"

namespace liftmesh {

// Memory left by an earlier stage, with room for `room` numbers.
struct Memory {
    Buffer<std::int32_t> numbers;
    std::size_t room = 0;
};

struct Result {
    Buffer<std::int32_t> simplices, neighbors;  // triangle_count x 3
    Buffer<std::int32_t> hull;                  // hull_count rows, counter-clockwise
    std::size_t triangle_count = 0;
    std::size_t hull_count = 0;

    // The simplices take over `left`, unless more than an eighth of it would be wasted.
    void make_room(std::size_t triangles, std::size_t hull_vertices, Memory left = {}) {
        triangle_count = triangles;
        hull_count = hull_vertices;
        const bool filled = 3 * triangles >= left.room - left.room / 8 && left.room > 0;
        simplices = filled ? std::move(left.numbers) : allocate<std::int32_t>(3 * triangles);
        left.numbers.reset();
        neighbors = allocate<std::int32_t>(3 * triangles);
        hull = allocate<std::int32_t>(hull_vertices);
    }
};

}  // namespace liftmesh
