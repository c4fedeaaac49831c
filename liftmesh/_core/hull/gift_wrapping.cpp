#include "base/facets.hpp"
#include "base/floating_point.hpp"
#include "hull/lower_hull.hpp"
#include "paper/algorithm2.hpp"
#include "paper/facet_search.hpp"
#include "paper/grid.hpp"
#include "paper/lfres_indexed.hpp"
#include "paper/points.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

namespace {

// q in the scale of the points. Overflow is clamped to the largest double: any vertex of the
// paraboloid gives the same facets.
Point scaled(Point q, const Scale& scale) {
    const auto limited = [](double value) {
        constexpr double most = std::numeric_limits<double>::max();
        return std::clamp(value, -most, most);
    };
    const Point moved = scale.moves ? scale(q) : q;
    return {limited(moved.x) + 0.0, limited(moved.y) + 0.0};
}

}  // namespace

Delaunay wrap_delaunay(const Input& input, bool skip_non_finite, Procedure procedure, Point q,
                       Threads threads, Interrupt& interrupt, paper::Counts& counts) {
    const IeeeArithmetic ieee;
    Order order;
    Delaunay outcome = start(input, skip_non_finite, threads, interrupt, order);
    if (outcome.status != Status::ok) return outcome;
    const std::span<Site> sites(order.sites.get(), order.count);
    std::optional<paper::Grid> grid;
    // The work of LF and LFRes depends on the order of P, which is that of the caller's rows.
    if (procedure == Procedure::lfres_indexed) {
        grid.emplace(sites);
    } else {
        sort_by_row(order);
    }
    std::vector<Point> points(sites.size());
    std::transform(sites.begin(), sites.end(), points.begin(),
                   [](const Site& site) { return site.point; });
    const auto wrap = [&](Point vertex, auto make_procedure) {
        const paper::LiftedPoints p(points, vertex, order.scale.guard);
        auto facet_through = make_procedure(p);
        std::vector<Facet> facets;
        outcome.status = paper::lower_convex_hull(p, facet_through, interrupt, facets);
        counts = facet_through.counts();
        if (outcome.status == Status::ok) outcome.status = emit(facets, sites, outcome.result);
    };
    using paper::LiftedPoints;
    if (procedure == Procedure::lf) {
        wrap(scaled(q, order.scale),
             [&](const LiftedPoints& p) { return paper::Lf(p, interrupt); });
    } else if (procedure == Procedure::lfres) {
        wrap(scaled(q, order.scale),
             [&](const LiftedPoints& p) { return paper::LfRes(p, interrupt); });
    } else {
        // Here q affects the first edge alone: best is one close to the points.
        wrap(points.front(), [&](const LiftedPoints& p) {
            return paper::LfResIndexed(*grid, points.data(), p.guard(), interrupt);
        });
    }
    return outcome;
}

}  // namespace liftmesh
