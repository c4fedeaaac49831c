// The arrays that the caller gets: triangles over rows of the input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "base/buffer.hpp"

namespace liftmesh {

// What another stage has left, with room for so many numbers.
struct Memory {
    Buffer<std::int32_t> numbers;
    std::size_t room = 0;
};

struct Result {
    Buffer<std::int32_t> simplices, neighbors;  // triangle_count x 3
    Buffer<std::int32_t> hull;                  // hull_count rows, counter-clockwise
    std::size_t triangle_count = 0;
    std::size_t hull_count = 0;

    // The simplices move into `left`, unless much of it would be kept for nothing.
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
