#include "gift_wrapping.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "facets.hpp"
#include "floating_point.hpp"
#include "order.hpp"
#include "paper/algorithm2.hpp"
#include "paper/first_edge.hpp"
#include "paper/grid.hpp"
#include "paper/lf.hpp"
#include "paper/lfres.hpp"
#include "paper/lfres_indexed.hpp"
#include "paper/points.hpp"

namespace liftmesh {

namespace {

// The distinct points as the paper's P.
struct Numbered {
    std::vector<Point> points;
    std::vector<Row> rows;
};

// In the order of the caller's rows, on which the work of LF and LFRes depends.
Numbered by_row(const Order& order) {
    std::vector<std::uint32_t> place(order.count);
    std::iota(place.begin(), place.end(), 0);
    std::sort(place.begin(), place.end(),
              [&](std::uint32_t i, std::uint32_t j) { return order.rows[i] < order.rows[j]; });
    Numbered p;
    p.points.reserve(order.count);
    p.rows.reserve(order.count);
    for (std::uint32_t i : place) {
        p.points.push_back(order.points[i]);
        p.rows.push_back(order.rows[i]);
    }
    return p;
}

Numbered as_ordered(const Order& order) {
    return {{order.points.get(), order.points.get() + order.count},
            {order.rows.get(), order.rows.get() + order.count}};
}

// q as seen from the points' scale. One that leaves the range of doubles stays on its brink: every
// vertex of the paraboloid gives the same facets.
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
                       Interrupt& interrupt, paper::Counts& counts) {
    const IeeeArithmetic ieee;
    Order order;
    Delaunay outcome = start(input, skip_non_finite, interrupt, order);
    if (outcome.status != Status::ok) return outcome;
    const Guard guard = order.scale.guard;
    const auto wrap = [&](const paper::LiftedPoints& p, auto facet_through, const Numbered& named) {
        std::vector<Facet> facets;
        if (const auto e1 = paper::FirstEdgeSearch(p).find())
            facets = paper::LowerConvexHull(facet_through).wrap(e1->v1, e1->end);
        counts = facet_through.counts();
        outcome.status = facet_through.interrupted()
                             ? Status::interrupted
                             : emit(facets, named.points, named.rows, outcome.result);
    };
    Numbered named = procedure == Procedure::lfres_indexed ? as_ordered(order) : by_row(order);
    if (procedure == Procedure::lfres_indexed) {
        const paper::Grid grid(named.points, named.rows);
        const paper::LiftedPoints p(named.points, scaled(q, order.scale), guard);
        wrap(p, paper::LfResIndexed(grid, named.points.data(), guard, interrupt), named);
        return outcome;
    }
    const paper::LiftedPoints p(named.points, scaled(q, order.scale), guard);
    if (procedure == Procedure::lf) {
        wrap(p, paper::Lf(p, interrupt), named);
    } else {
        wrap(p, paper::LfRes(p, interrupt), named);
    }
    return outcome;
}

}  // namespace liftmesh
