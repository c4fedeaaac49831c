#include "surface/local_surface.hpp"

namespace liftmesh {

bool LocalSurface::read(const Relief& relief, Interrupt& interrupt) {
    const Triangulated& mesh = relief.mesh();
    std::vector<std::int32_t> ranks;
    if (!rank_rows(mesh.points, mesh.simplices, mesh.count, ranks, interrupt, RowOrder::curve))
        return false;
    const std::size_t used =
        ranks.size() - static_cast<std::size_t>(std::count(ranks.begin(), ranks.end(), -1));
    const Triangles given{mesh.simplices, mesh.neighbors, nullptr, mesh.count};
    ThreadPool alone({}, interrupt);  // may itself be a task
    if (!order_triangles(given, ranks.data(), used, triangles_, alone)) return false;
    for (std::size_t i = 0; i < 3 * mesh.count; ++i)
        triangles_.simplices[i] = ranks[static_cast<std::size_t>(triangles_.simplices[i])];
    corners_.resize(used);
    for (std::size_t row = 0; row < ranks.size(); ++row)
        if (ranks[row] >= 0)
            corners_[static_cast<std::size_t>(ranks[row])] = {
                mesh.points[row], relief.height_of(static_cast<std::int32_t>(row))};
    for (const SurfaceCorner& each : corners_)
        largest_ = std::max({largest_, std::fabs(each.at.x), std::fabs(each.at.y)});
    shown_.resize(mesh.count);
    for (std::size_t i = 0; i < mesh.count; ++i)
        shown_[static_cast<std::size_t>(triangles_.names[i])] =
            relief.is_shown(static_cast<std::int32_t>(i));
    return true;
}

bool LocalSurface::is_before(const LocalSurface& other) const {
    if (vertices() != other.vertices()) return vertices() < other.vertices();
    for (std::size_t i = 0; i < vertices(); ++i) {
        const Point own = corners_[i].at, its = other.corners_[i].at;
        if (own != its) return before_xy(own, its);
    }
    return false;
}

Face LocalSurface::face(std::int32_t face) const {
    const SurfaceCorner &a = corner(vertex(face, 0)), &b = corner(vertex(face, 1)),
                        &c = corner(vertex(face, 2));
    const auto [left, right] = std::minmax({a.at.x, b.at.x, c.at.x});
    const auto [low, high] = std::minmax({a.at.y, b.at.y, c.at.y});
    return {{a, b, c}, 0, std::max(right - left, high - low)};
}

void LocalSurface::hide_flat(Nearness nearness) {
    for (std::size_t i = 0; i < shown_.size(); ++i)
        if (shown_[i] != 0)
            shown_[i] = is_flat(face(static_cast<std::int32_t>(i)), nearness) ? 2 : 1;
}

}  // namespace liftmesh
