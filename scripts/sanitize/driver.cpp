// Runs whatever the kernel does on several threads, for a sanitizer to watch: `driver ROWS
// WRITERS`. Rows are changed amid runs on up to WRITERS threads; ThreadSanitizer would call these
// races.
//
// Results are compared with those of one thread. Runs are interrupted in their middle, and several
// run at the same time, as they do where Python's threads share one limit.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "checks.hpp"
#include "clouds.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "hull/lower_hull.hpp"
#include "paper/facet_search.hpp"
#include "patient.hpp"
#include "verify/verify.hpp"

namespace parallel {

namespace {

using liftmesh::Delaunay;
using liftmesh::Status;
using liftmesh::Threads;

Delaunay run(const Cloud& cloud, Threads threads, std::size_t patience = ~std::size_t{0}) {
    Patient interrupt(patience);
    return liftmesh::delaunay(cloud.input(), true, threads, interrupt);
}

bool same(const Delaunay& a, const Delaunay& b) {
    const std::size_t count = a.result.triangle_count;
    if (a.status != b.status || count != b.result.triangle_count) return false;
    const auto equal = [&](const auto& x, const auto& y) {
        return count == 0 || std::memcmp(x.get(), y.get(), 3 * count * sizeof(x[0])) == 0;
    };
    return a.skipped == b.skipped && a.duplicates.size() == b.duplicates.size() &&
           equal(a.result.simplices, b.result.simplices) &&
           equal(a.result.neighbors, b.result.neighbors);
}

void on_many_threads(const Cloud& cloud, const Delaunay& alone) {
    for (const unsigned threads : {2u, 3u, 5u, 8u})
        demand(same(run(cloud, {threads, false}), alone), cloud, "threads change the result");
}

void interrupted(const Cloud& cloud, const Delaunay& alone) {
    for (const std::size_t patience : {1u, 2u, 4u, 9u, 20u, 60u}) {
        const Delaunay found = run(cloud, {4, false}, patience);
        demand(found.status == Status::interrupted || same(found, alone), cloud,
               "a run that could be interrupted comes to another result");
    }
}

void at_the_same_time(const Cloud& cloud, const Delaunay& alone) {
    std::vector<std::thread> callers;
    std::atomic<int> different = 0;
    for (int i = 0; i < 4; ++i)
        callers.emplace_back([&, i] { different += !same(run(cloud, {3, i % 2 == 0}), alone); });
    for (std::thread& caller : callers) caller.join();
    demand(different == 0, cloud, "runs at the same time change one another's result");
}

void verified(const Cloud& cloud, const std::vector<std::int32_t>& corners, std::size_t vertices) {
    const auto verdict = [&](unsigned threads, std::size_t patience) {
        Patient interrupt(patience);
        return liftmesh::verify(cloud.input(), corners.data(), corners.size() / 3, true,
                                {threads, false}, interrupt);
    };
    const liftmesh::Verdict alone = verdict(1, ~std::size_t{0}), many = verdict(4, ~std::size_t{0});
    demand(many.status == Status::ok && many.vertices == vertices && !many.flaws.any(), cloud,
           "the verifier finds other vertices, or flaws");
    demand(
        many.interior_edges == alone.interior_edges && many.boundary_edges == alone.boundary_edges,
        cloud, "threads change the verdict");
    for (const std::size_t patience : {1u, 3u, 8u}) verdict(3, patience);
}

// Triangles as they were made, in disorder, and without shared vertices.
void verified(const Cloud& cloud, const Delaunay& found) {
    const std::size_t count = found.result.triangle_count;
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937_64(count));
    const std::int32_t* simplices = found.result.simplices.get();
    const std::vector<std::int32_t> corners(simplices, simplices + 3 * count);
    std::vector<std::int32_t> shuffled, own(3 * count);
    for (const std::size_t t : order)
        shuffled.insert(shuffled.end(), simplices + 3 * t, simplices + 3 * t + 3);
    Cloud unshared{cloud.name + ", unshared", {}};
    for (const std::int32_t corner : corners) unshared.points.push_back(cloud.points[corner]);
    std::iota(own.begin(), own.end(), 0);
    verified(cloud, corners, found.distinct);
    verified(cloud, shuffled, found.distinct);
    verified(unshared, own, found.distinct);
}

// The rows of one cloud in the triangulation of it, and near its middle, where fans have their
// centre: by one thread, by many, interrupted, and by callers that need the index at the same time.
void located(const Cloud& cloud, const Delaunay& found) {
    std::vector<double> asked;
    for (const liftmesh::Point p : cloud.points)
        asked.insert(asked.end(), {p.x, p.y, 1e-3 * p.x, 1e-3 * p.y});
    const std::size_t count = asked.size() / 2;
    liftmesh::Locator locator({cloud.input(), found.result.simplices.get(),
                               found.result.neighbors.get(), found.result.triangle_count},
                              count);
    const auto answers = [&](unsigned threads, std::size_t patience) {
        std::vector<std::int32_t> at(count);
        Patient interrupt(patience);
        if (!locator.find({asked.data(), count}, at.data(), {threads, false}, interrupt)) at = {};
        return at;
    };
    for (const std::size_t patience : {1u, 3u, 8u}) answers(3, patience);
    std::vector<std::thread> callers;
    std::vector<std::vector<std::int32_t>> by(4);
    for (std::vector<std::int32_t>& each : by)
        callers.emplace_back([&] { each = answers(3, ~std::size_t{0}); });
    for (std::thread& caller : callers) caller.join();
    for (const std::vector<std::int32_t>& each : by)
        demand(each == answers(1, ~std::size_t{0}), cloud, "threads change where points are");
}

// The other engines arrange their points on several threads.
void arranged(const Cloud& cloud) {
    Patient interrupt(40);  // not the wrapping
    liftmesh::paper::Counts counts;
    liftmesh::wrap_delaunay(cloud.input(), true, liftmesh::Procedure::lfres_indexed, {0, 0},
                            {4, false}, interrupt, counts);
}

void check(const Cloud& cloud) {
    const Delaunay alone = run(cloud, {});
    on_many_threads(cloud, alone);
    interrupted(cloud, alone);
    at_the_same_time(cloud, alone);
    arranged(cloud);
    if (alone.status == Status::ok && alone.result.triangle_count > 0) {
        verified(cloud, alone);
        located(cloud, alone);
        check_cells(cloud, alone);
        check_surfaces(cloud, alone);
    }
    check_family(cloud);
    check_tiles(cloud, alone.result.triangle_count);
    check_changes(cloud);
    check_constraints(cloud);
    check_disks(cloud);
    check_space(cloud);
    check_overlays(cloud);
    std::printf("%s: %zu rows, %zu triangles\n", cloud.name.c_str(), cloud.points.size(),
                alone.result.triangle_count);
    std::fflush(stdout);
}

}  // namespace

}  // namespace parallel

int main(int, char** arguments) {
    const std::size_t rows = std::stoul(arguments[1]);
    parallel::check_text(rows);
    const auto writers = static_cast<unsigned>(std::stoul(arguments[2]));
    parallel::check_spoilt_rows(rows / 2, writers);
    parallel::check_spoilt_surfaces(rows / 10, writers);
    for (const parallel::Cloud& cloud : parallel::clouds(rows)) parallel::check(cloud);
}
