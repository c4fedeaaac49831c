#include "disk_graphs.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "disk_arrays.hpp"
#include "rows.hpp"
#include "stars.hpp"

namespace portability {

namespace {

using liftmesh::Point;
using liftmesh::anisotropic::Metric;
using native::Disk;
using native::DiskArrays;

template <class T>
void add(Digest& digest, const std::vector<T>& values) {
    if (!values.empty()) digest.add(values.data(), values.size() * sizeof(T));
}

std::vector<Point> finite(const double* coordinates, std::size_t rows) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < rows; ++i)
        if (const Point p{coordinates[2 * i] + 0.0, coordinates[2 * i + 1] + 0.0};
            liftmesh::is_finite(p))
            points.push_back(p);
    return points;
}

// Radii are parts of the extent, by sums, products and quotients alone.
std::vector<Disk> disks_around(const std::vector<Point>& points) {
    double side = 0;
    for (const Point p : points) side = std::max({side, std::fabs(p.x), std::fabs(p.y)});
    const double unit = side / std::sqrt(static_cast<double>(points.size()));
    std::vector<Disk> disks;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double part = static_cast<double>(i * 2654435761 % 4096) / 4096;
        disks.push_back({points[i].x, points[i].y, i % 3 == 0 ? 0 : unit * part});
    }
    return disks;
}

void add_graph(const std::vector<Disk>& disks, Digests& digests) {
    if (disks.empty() || !native::have_exact_signs(disks)) return;
    liftmesh::NoInterrupt never;
    const DiskArrays found(liftmesh::apollonius::apollonius(disks, 5, never));
    Digest& graph = digests.of["graph of disks"];
    for (const auto* list : {&found.simplices, &found.neighbors, &found.hull, &found.hidden})
        add(graph, *list);
    add(digests.of["circles of disks"], found.circles);
    demand(!liftmesh::verify(found.of(disks), 6, {3, false}, never).flaws.any(),
           "a graph of disks has flaws");
}

void add_stars(const std::vector<Point>& points, Digests& digests) {
    liftmesh::NoInterrupt never;
    const auto given = points.empty() ? nullptr : reinterpret_cast<const double*>(points.data());
    const auto euclidean =
        liftmesh::delaunay(native::input_of(given, points.size()), false, {}, never);
    if (euclidean.status != liftmesh::Status::ok) return;
    std::vector<Metric> metrics;
    for (std::size_t i = 0; i < points.size(); ++i)
        metrics.push_back({1 + static_cast<double>(i % 5), static_cast<double>(i % 3) / 2,
                           1 + static_cast<double>(i % 4)});
    const native::Neighborhood around(euclidean.result, points.size());
    liftmesh::anisotropic::Lists found;
    demand(liftmesh::anisotropic::stars({points, metrics, around.starts, around.rows, around.hull},
                                        never, found),
           "interrupted stars");
    add(digests.of["stars"], found.starts);
    add(digests.of["stars"], found.rows);
}

}  // namespace

void add_disks(const double* coordinates, std::size_t rows, Digests& digests) {
    const std::vector<Point> points = finite(coordinates, rows);
    add_graph(disks_around(points), digests);
    const std::size_t few = std::min<std::size_t>(points.size(), 2000);
    add_stars({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(few)}, digests);
}

}  // namespace portability
