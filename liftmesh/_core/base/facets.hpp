// Facets in a list, each with its neighbours: what the engines make that know no static slots.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/point.hpp"
#include "base/result.hpp"
#include "base/site.hpp"
#include "base/status.hpp"

namespace liftmesh {

// Counter-clockwise as seen from above. Edge k faces vertex k, and runs from vertex k + 1 to vertex
// k + 2.
struct Facet {
    static constexpr std::uint32_t unknown = ~std::uint32_t{0};
    static constexpr std::uint32_t none = unknown - 1;

    std::array<Vertex, 3> vertex;
    std::array<std::uint32_t, 3> neighbor = {unknown, unknown, unknown};

    Vertex tail(unsigned k) const { return vertex[k == 2 ? 0 : k + 1]; }
    Vertex head(unsigned k) const { return vertex[k == 0 ? 2 : k - 1]; }
};

// `sites` tells the position and the row of each vertex. Without facets all points are on one line,
// and the hull is its two ends.
Status emit(const std::vector<Facet>& facets, std::span<const Site> sites, Result& result);

}  // namespace liftmesh
