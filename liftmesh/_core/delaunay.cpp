#include "delaunay.hpp"

#include <utility>

#include "divide_conquer.hpp"
#include "floating_point.hpp"

namespace liftmesh {

Delaunay start(const Input& input, bool skip_non_finite, Interrupt& interrupt, Order& order) {
    Delaunay outcome;
    const OrderResult arranged = arrange(input, skip_non_finite, interrupt, order);
    outcome.status = arranged.status;
    outcome.row = arranged.row;
    if (outcome.status != Status::ok) return outcome;
    outcome.distinct = order.count;
    outcome.duplicates = std::move(order.duplicates);
    outcome.skipped = std::move(order.skipped);
    if (order.count < 3) outcome.status = Status::too_few;
    return outcome;
}

Delaunay delaunay(const Input& input, bool skip_non_finite, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Order order;
    Delaunay outcome = start(input, skip_non_finite, interrupt, order);
    if (outcome.status != Status::ok) return outcome;
    const auto triangles = std::make_unique_for_overwrite<Triangle[]>(2 * order.count - 2);
    outcome.status = divide_and_conquer(order, triangles.get(), interrupt);
    if (outcome.status != Status::ok) return outcome;
    const Mesh mesh(order.points.get(), triangles.get());
    outcome.status = emit(mesh, order.rows.get(), order.count, interrupt, outcome.result);
    return outcome;
}

}  // namespace liftmesh
