#include "delaunay/first_containing.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

// Goes around a corner counter-clockwise and, if that reaches the hull, clockwise from the start.
std::int32_t first_around(const Triangulated& mesh, std::int32_t start, int corner,
                          std::size_t& steps) {
    const std::int32_t centre = mesh.vertex(start, corner);
    std::int32_t least = start;
    for (const int turn : {1, 2}) {
        std::int32_t at = start;
        int place = corner;
        for (;; --steps) {
            if (steps == 0) return unfinished;
            at = mesh.neighbor(at, (place + turn) % 3);
            if (at == start) return least;
            if (at < 0) break;
            least = std::min(least, at);
            place = mesh.vertex(at, 0) == centre ? 0 : mesh.vertex(at, 1) == centre ? 1 : 2;
        }
    }
    return least;
}

}  // namespace

std::int32_t first_containing(const Triangulated& mesh, Point query, std::int32_t triangle,
                              std::size_t& steps) {
    int turn[3], on = 0;
    for (int k = 0; k < 3; ++k) {
        turn[k] =
            orient2d(mesh.corner(triangle, (k + 1) % 3), mesh.corner(triangle, (k + 2) % 3), query);
        if (turn[k] < 0) return outside;
        on += turn[k] == 0;
    }
    if (on == 0) return triangle;
    if (on == 2)
        return first_around(mesh, triangle, turn[0] != 0 ? 0 : turn[1] != 0 ? 1 : 2, steps);
    const int side = turn[0] == 0 ? 0 : turn[1] == 0 ? 1 : 2;
    const std::int32_t across = mesh.neighbor(triangle, side);
    return across < 0 ? triangle : std::min(triangle, across);
}

std::int32_t vertex_at(const Triangulated& mesh, Point query, std::int32_t triangle) {
    for (int k = 0; k < 3; ++k)
        if (mesh.corner(triangle, k) == query) return mesh.vertex(triangle, k);
    return outside;
}

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
