#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "checks.hpp"
#include "disk_arrays.hpp"
#include "patient.hpp"
#include "stars.hpp"

namespace parallel {

namespace {

using liftmesh::Point;
using liftmesh::Status;
using liftmesh::anisotropic::Metric;
using native::Disk;
using native::DiskArrays;

// Every third radius is 0; of the others, some disks are within others.
std::vector<Disk> disks_around(const std::vector<Point>& points) {
    double side = 0;
    for (const Point p : points) side = std::fmax(side, std::fmax(std::fabs(p.x), std::fabs(p.y)));
    const double unit = side / std::sqrt(static_cast<double>(points.size()));
    std::vector<Disk> disks;
    for (std::size_t i = 0; i < points.size(); ++i)
        disks.push_back({points[i].x, points[i].y, i % 3 == 0 ? 0 : unit * double(i % 7) / 4});
    return disks;
}

void graphs(const Cloud& cloud, const std::vector<Point>& points) {
    const std::vector<Disk> disks = disks_around(points);
    if (!native::have_exact_signs(disks)) return;
    const auto made = [&](std::uint64_t secret, std::size_t patience) {
        Patient interrupt(patience);
        return liftmesh::apollonius::apollonius(disks, secret, interrupt);
    };
    const DiskArrays alone(made(1, ~std::size_t{0}));
    std::thread other([&] {
        demand(DiskArrays(made(2, ~std::size_t{0})) == alone, cloud, "the graph of disks differs");
    });
    made(3, 1);
    const auto flawed = [&](const DiskArrays& graph, unsigned threads, std::size_t patience) {
        Patient interrupt(patience);
        const auto verdict = liftmesh::verify(graph.of(disks), 4, {threads, false}, interrupt);
        return verdict.status == Status::ok && verdict.flaws.any();
    };
    demand(!flawed(alone, 1, ~std::size_t{0}) && !flawed(alone, 4, ~std::size_t{0}), cloud,
           "the graph of disks has flaws");
    for (const std::size_t patience : {1u, 2u, 5u}) flawed(alone, 3, patience);
    DiskArrays spoilt = alone;
    if (!spoilt.simplices.empty()) {
        std::swap(spoilt.simplices.front(), spoilt.simplices.back());
        demand(spoilt == alone || flawed(spoilt, 4, ~std::size_t{0}), cloud,
               "a spoilt graph has no flaws");
    }
    other.join();
}

void stars(const Cloud& cloud, const std::vector<Point>& points) {
    Patient never;
    const liftmesh::Input input{reinterpret_cast<const std::byte*>(points.data()), points.size(),
                                sizeof(Point), sizeof(double), false};
    const auto euclidean = liftmesh::delaunay(input, false, {}, never);
    if (euclidean.status != Status::ok) return;
    std::vector<Metric> metrics;
    for (std::size_t i = 0; i < points.size(); ++i)
        metrics.push_back({1 + double(i % 5), double(i % 3) / 2, 1 + double(i % 4)});
    const native::Neighborhood given(euclidean.result, points.size());
    const auto made = [&](std::size_t patience) {
        Patient interrupt(patience);
        liftmesh::anisotropic::Lists found;
        liftmesh::anisotropic::stars({points, metrics, given.starts, given.rows, given.hull},
                                     interrupt, found);
        return found;
    };
    const auto alone = made(~std::size_t{0});
    std::thread other(
        [&] { demand(made(~std::size_t{0}).rows == alone.rows, cloud, "the stars differ"); });
    made(2);
    other.join();
}

}  // namespace

void check_disks(const Cloud& cloud) {
    graphs(cloud, finite(cloud, 20000));
    stars(cloud, finite(cloud, 2000));
}

}  // namespace parallel
