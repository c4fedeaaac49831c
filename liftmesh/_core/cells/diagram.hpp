// The vertices of Voronoi and power diagrams, from the triangles that are dual to them.
//
// A vertex of the diagram belongs to all triangles whose lifted corners lie in one plane: sites on
// one circle share a vertex, however ties cut their polygon into triangles.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/buffer.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// Triangles of a finished triangulation over plain rows. Without values sites are not lowered.
struct Dual {
    enum class Kind : std::uint8_t { plain, weights, radii };

    const Point* points;
    const double* values;  // one for each row
    Kind kind;
    std::size_t rows;
    const std::int32_t *simplices, *neighbors;  // count x 3
    std::size_t count;

    std::int32_t vertex(std::int32_t t, int k) const { return simplices[word(t, k)]; }
    std::int32_t neighbor(std::int32_t t, int k) const { return neighbors[word(t, k)]; }
    // Which corner of a triangle a row is.
    int place(std::int32_t t, std::int32_t row) const {
        return (vertex(t, 1) == row) + 2 * (vertex(t, 2) == row);
    }

 private:
    static std::size_t word(std::int32_t t, int k) {
        return 3 * static_cast<std::size_t>(t) + static_cast<std::size_t>(k);
    }
};

struct Vertices {
    Buffer<Point> points;
    std::size_t count = 0;
    Buffer<std::int32_t> of;   // the vertex of each triangle
    std::size_t infinite = 0;  // vertices with a coordinate beyond the doubles
};

// False if the interrupt came first.
bool make_vertices(const Dual& dual, Threads threads, Interrupt& interrupt, Vertices& vertices);

}  // namespace liftmesh
