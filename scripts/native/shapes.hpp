// All that the kernel computes of alpha complexes, of graphs of near points and of directions, as
// one list of numbers; empty if an interrupt came first.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "alpha/alpha.hpp"
#include "proximity/proximity.hpp"
#include "sphere/sphere.hpp"

namespace native {

using Numbers = std::vector<double>;

inline liftmesh::Input input_of(const std::vector<liftmesh::SpacePoint>& points) {
    return {reinterpret_cast<const std::byte*>(points.data()), points.size(),
            sizeof(liftmesh::SpacePoint), sizeof(double), false};
}

template <class List>
void add(Numbers& all, const List& values) {
    all.insert(all.end(), values.begin(), values.end());
}

template <std::size_t K>
void add(Numbers& all, const std::vector<std::array<std::int32_t, K>>& lists) {
    for (const auto& each : lists) add(all, each);
}

// Radii, the complex, the shape of the median radius, and the least alpha of a whole one.
template <int K>
Numbers alpha_numbers(const liftmesh::SimplexView<K>& view, std::size_t rows,
                      liftmesh::Interrupt& interrupt) {
    if (view.count == 0) return {};
    Numbers nearest(view.count), radii(view.count);
    liftmesh::AlphaFiltration<K> complex;
    liftmesh::AlphaSurface<K> surface;
    std::vector<std::uint8_t> is_inside(view.count);
    const auto radii_of = [&](liftmesh::RadiusRounding rounding, double* found) {
        return liftmesh::circumradii<K>(view.points, view.simplices, view.count, rounding,
                                        interrupt, found);
    };
    if (!radii_of(liftmesh::RadiusRounding::nearest, nearest.data()) ||
        !radii_of(liftmesh::RadiusRounding::up, radii.data()) ||
        !liftmesh::find_alpha_filtration(view, radii.data(), interrupt, complex))
        return {};
    Numbers sorted = radii;
    std::sort(sorted.begin(), sorted.end());
    const double alpha = sorted[sorted.size() / 2];
    if (!liftmesh::find_alpha_surface(view, alpha, interrupt, is_inside.data(), surface)) return {};
    const double whole = liftmesh::solid_alpha(view.simplices, view.neighbors, view.count, K, rows,
                                               radii.data(), 1, interrupt);
    if (std::isnan(whole)) return {};
    Numbers all{whole};
    for (const Numbers* each : {&nearest, &radii, &complex.facets.radii, &complex.edges.radii})
        add(all, *each);
    add(all, complex.facets.corners);
    add(all, complex.edges.corners);
    add(all, is_inside);
    add(all, surface.facets);
    add(all, surface.singular);
    return all;
}

// The graphs of near points, with lengths.
inline Numbers graph_numbers(const liftmesh::Triangulated& mesh, liftmesh::Interrupt& interrupt) {
    using liftmesh::Proximity;
    Numbers all;
    for (const auto kind : {Proximity::gabriel, Proximity::relative_neighborhood,
                            Proximity::minimum_spanning_tree, Proximity::sphere_of_influence}) {
        std::vector<std::array<std::int32_t, 2>> edges;
        if (!liftmesh::find_proximity_graph(mesh, kind, interrupt, edges)) return {};
        Numbers lengths(edges.size());
        if (!liftmesh::find_lengths(mesh.points, edges, interrupt, lengths.data())) return {};
        add(all, edges);
        add(all, lengths);
    }
    return all;
}

// The triangulation of the directions of rows, without those that have none, and its cells.
inline Numbers sphere_numbers(std::vector<liftmesh::SpacePoint> points, std::uint64_t secret,
                              liftmesh::Interrupt& interrupt) {
    std::erase(points, liftmesh::SpacePoint{0, 0, 0});
    const auto found = liftmesh::triangulate_sphere(input_of(points), true, secret, interrupt);
    if (found.status == liftmesh::Status::interrupted) return {};
    Numbers all{static_cast<double>(found.status), static_cast<double>(found.distinct)};
    if (found.status != liftmesh::Status::ok) return all;
    add(all, found.simplices);
    add(all, found.neighbors);
    const std::int32_t* const simplices = found.simplices.data()->data();
    std::vector<liftmesh::SpacePoint> centres(found.simplices.size());
    liftmesh::SphereCells cells;
    if (!liftmesh::find_circle_centres(points.data(), simplices, centres.size(), interrupt,
                                       centres.data()) ||
        !liftmesh::find_sphere_cells(simplices, found.neighbors.data()->data(), centres.size(),
                                     points.size(), interrupt, cells))
        return {};
    for (const liftmesh::SpacePoint& p : centres) all.insert(all.end(), {p.x, p.y, p.z});
    add(all, cells.starts);
    add(all, cells.facets);
    return all;
}

}  // namespace native
