#include "facets.hpp"

#include <algorithm>
#include <memory>

namespace liftmesh {

namespace {

constexpr Vertex no_vertex = ~Vertex{0};

std::vector<Vertex> ends_of_line(std::span<const Point> points) {
    const auto [first, last] = std::minmax_element(points.begin(), points.end(), before_xy);
    return {static_cast<Vertex>(first - points.begin()),
            static_cast<Vertex>(last - points.begin())};
}

// The bound-edges, one after the other, counter-clockwise from the lexicographically least vertex.
std::vector<Vertex> hull_of(const std::vector<Facet>& facets, std::span<const Point> points) {
    std::vector<Vertex> successor(points.size(), no_vertex), hull;
    Vertex start = no_vertex;
    for (const Facet& facet : facets) {
        for (unsigned k = 0; k < 3; ++k) {
            if (facet.neighbor[k] != Facet::none) continue;
            const Vertex tail = facet.tail(k);
            successor[tail] = facet.head(k);
            if (start == no_vertex || before_xy(points[tail], points[start])) start = tail;
        }
    }
    for (Vertex v = start; hull.empty() || v != start; v = successor[v]) hull.push_back(v);
    return hull;
}

}  // namespace

Status emit(const std::vector<Facet>& facets, std::span<const Point> points,
            std::span<const Row> rows, Result& result) {
    const std::vector<Vertex> hull =
        facets.empty() ? ends_of_line(points) : hull_of(facets, points);
    result.triangle_count = facets.size();
    result.hull_count = hull.size();
    result.simplices = std::make_unique_for_overwrite<std::int32_t[]>(3 * facets.size());
    result.neighbors = std::make_unique_for_overwrite<std::int32_t[]>(3 * facets.size());
    result.hull = std::make_unique_for_overwrite<std::int32_t[]>(hull.size());
    std::int32_t* simplex = result.simplices.get();
    std::int32_t* neighbor = result.neighbors.get();
    for (const Facet& facet : facets) {
        for (unsigned k = 0; k < 3; ++k) {
            *simplex++ = static_cast<std::int32_t>(rows[facet.vertex[k]]);
            *neighbor++ = facet.neighbor[k] == Facet::none
                              ? -1
                              : static_cast<std::int32_t>(facet.neighbor[k]);
        }
    }
    std::transform(hull.begin(), hull.end(), result.hull.get(),
                   [&](Vertex v) { return static_cast<std::int32_t>(rows[v]); });
    return facets.empty() ? Status::collinear : Status::ok;
}

}  // namespace liftmesh
