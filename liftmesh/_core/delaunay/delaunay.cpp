#include "delaunay/delaunay.hpp"

#include "base/floating_point.hpp"
#include "delaunay/divide_conquer.hpp"
#include "predicates/lift.hpp"

namespace liftmesh {

Delaunay start(const Input& input, bool skip_non_finite, ThreadPool& pool, Order& order,
               const Range& other) {
    Delaunay outcome;
    const OrderResult sorted = spatial_sort(input, skip_non_finite, pool, order, other);
    outcome.status = sorted.status;
    outcome.row = sorted.row;
    if (outcome.status != Status::ok) return outcome;
    outcome.distinct = order.count;
    outcome.duplicates = std::move(order.duplicates);
    outcome.skipped = std::move(order.skipped);
    if (order.count < 3) outcome.status = Status::too_few;
    return outcome;
}

Delaunay start(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt,
               Order& order) {
    ThreadPool pool(threads.for_rows(input.rows), interrupt);
    return start(input, skip_non_finite, pool, order);
}

namespace {

template <class Triangulate>
Delaunay run(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt,
             Triangulate triangulate) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(input.rows), interrupt);
    interrupt.expect(input.rows * (work::sorting + work::triangulating + work::compacting));
    Order order;
    Delaunay outcome = start(input, skip_non_finite, pool, order);
    if (outcome.status != Status::ok) return outcome;
    Construction construction;
    outcome.status = triangulate(order, pool, construction);
    if (outcome.status != Status::ok) return outcome;
    outcome.status = compact(std::move(construction), pool, outcome.result);
    return outcome;
}

}  // namespace

Delaunay delaunay(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    return run(input, skip_non_finite, threads, interrupt,
               [](Order& order, ThreadPool& pool, Construction& result) {
                   return divide_and_conquer(Paraboloid{}, order.scale.guard, order, pool, result);
               });
}

Delaunay delaunay(const ByMetric& by, const Input& input, bool skip_non_finite, Threads threads,
                  Interrupt& interrupt) {
    return run(input, skip_non_finite, threads, interrupt,
               [by](Order& order, ThreadPool& pool, Construction& result) {
                   ByMetric fitted = by;
                   const Guard guard = fit(fitted, order.scale.guard);
                   return divide_and_conquer(fitted, guard, order, pool, result);
               });
}

}  // namespace liftmesh
