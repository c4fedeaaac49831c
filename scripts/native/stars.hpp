// What the stars of points in metrics of their own start from: the neighbours of each row.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "anisotropic/stars.hpp"
#include "delaunay/delaunay.hpp"

namespace native {

struct Neighborhood {
    std::vector<std::int32_t> starts, rows, hull;

    Neighborhood(const liftmesh::Result& found, std::size_t count) : starts(count + 1, 0) {
        std::vector<std::array<std::int32_t, 2>> edges;
        for (std::size_t i = 0; i < 3 * found.triangle_count; ++i) {
            const std::int32_t a = found.simplices[i];
            const std::int32_t b = found.simplices[i % 3 == 2 ? i - 2 : i + 1];
            edges.insert(edges.end(), {{a, b}, {b, a}});
        }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        for (const auto& [a, b] : edges) {
            ++starts[static_cast<std::size_t>(a) + 1];
            rows.push_back(b);
        }
        for (std::size_t i = 0; i < count; ++i) starts[i + 1] += starts[i];
        for (std::size_t i = 0; i < found.hull_count; ++i)
            hull.insert(hull.end(), {found.hull[i], found.hull[(i + 1) % found.hull_count]});
    }
};

}  // namespace native
