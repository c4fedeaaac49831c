#include "base/facets.hpp"

namespace liftmesh {

namespace {

constexpr Vertex no_vertex = ~Vertex{0};

std::vector<Vertex> ends_of_line(std::span<const Site> sites) {
    const auto [first, last] = std::minmax_element(
        sites.begin(), sites.end(),
        [](const Site& a, const Site& b) { return before_xy(a.point, b.point); });
    return {static_cast<Vertex>(first - sites.begin()), static_cast<Vertex>(last - sites.begin())};
}

// The vertices of the boundary, counter-clockwise from the lexicographically least.
std::vector<Vertex> hull_of(const std::vector<Facet>& facets, std::span<const Site> sites) {
    std::vector<Vertex> successor(sites.size(), no_vertex), hull;
    Vertex start = no_vertex;
    for (const Facet& facet : facets) {
        for (unsigned k = 0; k < 3; ++k) {
            if (facet.neighbor[k] != Facet::none) continue;
            const Vertex tail = facet.tail(k);
            successor[tail] = facet.head(k);
            if (start == no_vertex || before_xy(sites[tail].point, sites[start].point))
                start = tail;
        }
    }
    for (Vertex v = start; hull.empty() || v != start; v = successor[v]) hull.push_back(v);
    return hull;
}

}  // namespace

Status emit(const std::vector<Facet>& facets, std::span<const Site> sites, Result& result) {
    const std::vector<Vertex> hull = facets.empty() ? ends_of_line(sites) : hull_of(facets, sites);
    result.make_room(facets.size(), hull.size());
    std::int32_t* simplex = result.simplices.get();
    std::int32_t* neighbor = result.neighbors.get();
    for (const Facet& facet : facets) {
        for (unsigned k = 0; k < 3; ++k) {
            *simplex++ = static_cast<std::int32_t>(sites[facet.vertex[k]].row);
            *neighbor++ = facet.neighbor[k] == Facet::none
                              ? -1
                              : static_cast<std::int32_t>(facet.neighbor[k]);
        }
    }
    std::transform(hull.begin(), hull.end(), result.hull.get(),
                   [&](Vertex v) { return static_cast<std::int32_t>(sites[v].row); });
    return facets.empty() ? Status::collinear : Status::ok;
}

}  // namespace liftmesh
