#include "delaunay/hubs.hpp"

#include <algorithm>

namespace liftmesh {

Hubs::Hubs(const Triangulated& mesh, Patience& patience) {
    std::vector<std::uint8_t> degree(mesh.points.rows);
    const std::size_t corners = 3 * mesh.count;
    for (std::size_t i = 0; i < corners && !patience.ends(); ++i) {
        std::uint8_t& count = degree[static_cast<std::size_t>(mesh.simplices[i])];
        if (count < least_degree) ++count;
    }
    for (std::size_t i = 0; i < corners && !patience.ends(); ++i) {
        std::uint8_t& count = degree[static_cast<std::size_t>(mesh.simplices[i])];
        if (count < least_degree) continue;
        hubs_.emplace_back(mesh.simplices[i], static_cast<std::int32_t>(i / 3));
        count = 0;
    }
    std::sort(hubs_.begin(), hubs_.end());
}

std::int32_t Hubs::first_triangle(std::int32_t vertex) const {
    const auto at = std::lower_bound(hubs_.begin(), hubs_.end(), std::pair(vertex, 0));
    return at != hubs_.end() && at->first == vertex ? at->second : -1;
}

}  // namespace liftmesh
