#include "delaunay.hpp"

#include <utility>

#include "divide_conquer.hpp"
#include "emit.hpp"
#include "floating_point.hpp"

namespace liftmesh {

namespace {

// The sites' memory, which the simplices fill, unless much of it were kept for nothing.
Buffer<std::int32_t> memory_of_sites(Order& order) {
    static_assert(sizeof(Site) == 2 * 3 * sizeof(std::int32_t), "two triangles for each point");
    Buffer<Site> sites = std::move(order.sites);
    if (order.count < order.room - order.room / 8) return nullptr;
    return reuse<std::int32_t>(std::move(sites));
}

}  // namespace

Delaunay start(const Input& input, bool skip_non_finite, Team& team, Order& order) {
    Delaunay outcome;
    const OrderResult arranged = arrange(input, skip_non_finite, team, order);
    outcome.status = arranged.status;
    outcome.row = arranged.row;
    if (outcome.status != Status::ok) return outcome;
    outcome.distinct = order.count;
    outcome.duplicates = std::move(order.duplicates);
    outcome.skipped = std::move(order.skipped);
    if (order.count < 3) outcome.status = Status::too_few;
    return outcome;
}

Delaunay delaunay(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Team team(threads.for_rows(input.rows), interrupt);
    interrupt.expect(input.rows * (work::arranging + work::triangulating + work::emitting));
    Order order;
    Delaunay outcome = start(input, skip_non_finite, team, order);
    if (outcome.status != Status::ok) return outcome;
    Construction construction;
    outcome.status = divide_and_conquer(order, team, construction);
    if (outcome.status != Status::ok) return outcome;
    outcome.result.simplices = memory_of_sites(order);
    outcome.status = emit(construction, team, outcome.result);
    return outcome;
}

}  // namespace liftmesh
