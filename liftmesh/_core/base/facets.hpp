// `Result`, the output arrays of every engine; and lists of facets with their neighbours, from
// which the engines without static slots make it.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"
#include "base/status.hpp"

namespace liftmesh {

// The output arrays: triangles over rows of the input.
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

// Counter-clockwise seen from above. Edge k is opposite vertex k, and runs from vertex k + 1 to
// vertex k + 2.
struct Facet {
    static constexpr std::uint32_t unknown = ~std::uint32_t{0};
    static constexpr std::uint32_t none = unknown - 1;

    std::array<Vertex, 3> vertex;
    std::array<std::uint32_t, 3> neighbor = {unknown, unknown, unknown};

    Vertex tail(unsigned k) const { return vertex[k == 2 ? 0 : k + 1]; }
    Vertex head(unsigned k) const { return vertex[k == 0 ? 2 : k - 1]; }
};

// `sites` holds the position and the row of each vertex. Without facets all points are collinear,
// and the hull is the two ends of their line.
Status emit(const std::vector<Facet>& facets, std::span<const Site> sites, Result& result);

}  // namespace liftmesh
