// From slots to the caller's arrays: ghosts dropped, vertices named by their rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "mesh.hpp"
#include "status.hpp"

namespace liftmesh {

struct Result {
    std::unique_ptr<std::int32_t[]> simplices, neighbors;  // triangle_count x 3
    std::unique_ptr<std::int32_t[]> hull;                  // hull_count rows, counter-clockwise
    std::size_t triangle_count = 0;
    std::size_t hull_count = 0;
};

Status emit(const Mesh& mesh, const Row* rows, std::size_t points, Interrupt& interrupt,
            Result& result);

}  // namespace liftmesh
