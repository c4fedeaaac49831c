#include "hull/lower_hull.hpp"

#include "base/facets.hpp"
#include "base/floating_point.hpp"
#include "paper/algorithm2.hpp"
#include "paper/facet_search.hpp"
#include "paper/points.hpp"
#include "predicates/scale.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

namespace {

// Replaces the first row of each planar position by the lowest.
void take_lowest(const Input& input, const std::vector<Duplicate>& duplicates, Order& order) {
    if (duplicates.empty()) return;
    std::vector<Row> lowest(input.rows);
    for (std::size_t i = 0; i < order.count; ++i) lowest[order.sites[i].row] = order.sites[i].row;
    for (const Duplicate& pair : duplicates)
        if (input.height(pair.row) < input.height(lowest[pair.kept])) lowest[pair.kept] = pair.row;
    for (std::size_t i = 0; i < order.count; ++i) order.sites[i].row = lowest[order.sites[i].row];
}

struct Heights {
    std::vector<double> values;
    Guard guard;
};

// Scaled by a power of two of their own, which changes no sign.
Heights heights_of(const Input& input, const Order& order) {
    Range range;
    Heights z{std::vector<double>(order.count), order.scale.guard};
    for (std::size_t i = 0; i < order.count; ++i) {
        z.values[i] = input.height(order.sites[i].row);
        range.add({z.values[i], 0});
    }
    const Scale scale(range);
    if (scale.moves)
        for (double& value : z.values) value = scale({value, 0}).x;
    if (!scale.guard.vouches()) z.guard = scale.guard;
    return z;
}

std::vector<SpacePoint> in_space(const Order& order, const std::vector<double>& z) {
    std::vector<SpacePoint> points(order.count);
    for (std::size_t i = 0; i < order.count; ++i)
        points[i] = {order.sites[i].point.x, order.sites[i].point.y, z[i]};
    return points;
}

Status wrap(const paper::SpacePoints& p, Interrupt& interrupt, std::vector<Facet>& facets,
            paper::Counts& counts) {
    paper::Lf facet_through(p, interrupt);
    const Status status = paper::lower_convex_hull(p, facet_through, interrupt, facets);
    counts = facet_through.counts();
    return status;
}

}  // namespace

Delaunay lower_hull(const Input& input, HullMethod method, std::uint64_t secret, Threads threads,
                    Interrupt& interrupt, paper::Counts& counts) {
    const IeeeArithmetic ieee;
    Order order;
    Delaunay outcome = start(input, false, threads, interrupt, order);
    if (outcome.status != Status::ok) return outcome;
    if (method == HullMethod::lf) sort_by_row(order);
    take_lowest(input, outcome.duplicates, order);
    const Heights z = heights_of(input, order);
    std::vector<SpacePoint> points = in_space(order, z.values);
    std::vector<Facet> facets;
    outcome.status = method == HullMethod::lf
                         ? wrap({std::move(points), z.guard}, interrupt, facets, counts)
                         : incremental_hull(points, z.guard, secret, interrupt, facets);
    if (outcome.status != Status::ok) return outcome;
    outcome.status = emit(facets, {order.sites.get(), order.count}, outcome.result);
    return outcome;
}

}  // namespace liftmesh
