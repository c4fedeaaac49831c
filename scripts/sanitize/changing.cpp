#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "changing_edges.hpp"
#include "checks.hpp"
#include "dynamic/triangulation.hpp"
#include "patient.hpp"
#include "simplification/simplify.hpp"

namespace parallel {

namespace {

using liftmesh::Point;
using liftmesh::Vertex;

std::size_t fresh_triangles(const liftmesh::dynamic::Triangulation& mesh) {
    std::vector<Point> present;
    for (Vertex v = 0; v < mesh.vertex_end(); ++v)
        if (mesh.is_present(v)) present.push_back(mesh.point(v));
    liftmesh::NoInterrupt never;
    const auto input = liftmesh::dynamic::input_of(present);
    return liftmesh::delaunay(input, false, {}, never).result.triangle_count;
}

void come_and_go(const Cloud& cloud, const std::vector<Point>& points) {
    liftmesh::NoInterrupt never;
    liftmesh::dynamic::Triangulation mesh;
    std::vector<Vertex> found(points.size());
    const std::size_t half = points.size() / 2;
    for (std::size_t i = 0; i < half; ++i) found[i] = mesh.insert(points[i]);
    const std::vector<Point> rest(points.begin() + static_cast<std::ptrdiff_t>(half), points.end());
    mesh.insert(liftmesh::dynamic::input_of(rest), found.data() + half, never);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    for (std::size_t i = 0; i < found.size(); i += 3) mesh.remove(found[i]);
    demand(mesh.result().triangle_count == fresh_triangles(mesh), cloud, "triangles are missing");
    for (std::size_t i = 0; i < found.size(); ++i)
        if (i % 3 != 0) mesh.remove(found[i]);
    demand(mesh.size() == 0, cloud, "points are left");
}

// With constraints; those that are gone have left nothing.
void edges_come_and_go(const Cloud& cloud, const std::vector<Point>& points) {
    native::change_edges(points, [&](const liftmesh::dynamic::Triangulation& mesh) {
        if (mesh.constraints().empty())
            demand(mesh.result().triangle_count == fresh_triangles(mesh), cloud,
                   "triangles are missing where constraints were");
    });
}

// Few triangles within a bound: to the end and interrupted; not of points on a line.
void simplified(const Cloud& cloud, const std::vector<Point>& points) {
    liftmesh::NoInterrupt never;
    const auto whole = liftmesh::delaunay(liftmesh::dynamic::input_of(points), false, {}, never);
    if (whole.status != liftmesh::Status::ok) return;
    std::vector<double> heights;
    for (const Point p : points) heights.push_back(std::sin(9 * p.x) + std::cos(7 * p.y));
    const liftmesh::simplification::Terrain terrain{points.data(), heights.data(), points.size(),
                                                    whole.result.hull.get(),
                                                    whole.result.hull_count};
    for (const double tolerance : {0.0, 0.1}) {
        const auto within = liftmesh::simplification::simplify(terrain, tolerance, 0, true, never);
        demand(within.is_within && within.rows.size() <= points.size(), cloud, "not within");
    }
    std::vector<std::int32_t> edges;  // of the triangulation: none cross
    for (std::size_t i = 0; i < 3 * whole.result.triangle_count; i += 21)
        edges.insert(edges.end(), {whole.result.simplices[i], whole.result.simplices[i + 1]});
    auto followed = terrain;
    followed.edges = edges.data();
    followed.edge_count = edges.size() / 2;
    const auto along = liftmesh::simplification::simplify(followed, 0.1, 0, true, never);
    demand(along.is_within && along.rows.size() <= points.size(), cloud, "not within along edges");
    const auto few = liftmesh::simplification::simplify(terrain, 0, 40, false, never);
    const auto thinned = liftmesh::simplification::thin(terrain, points.size() / 2, never);
    demand(few.rows.size() <= std::max<std::size_t>(40, whole.result.hull_count), cloud,
           "more than asked for");
    demand(thinned.rows.size() <= points.size(), cloud, "not thinned");
    for (const std::size_t patience : {1u, 2u, 5u, 12u}) {
        Patient first(patience), second(patience);
        liftmesh::simplification::simplify(terrain, 0.01, 0, true, first);
        liftmesh::simplification::thin(terrain, 9, second);
    }
}

// Once each.
std::vector<Point> distinct(std::vector<Point> points) {
    std::sort(points.begin(), points.end(), liftmesh::before_xy);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

// A raster of as many pixels, some of them missing, whose step no double holds.
std::vector<Point> raster(std::size_t pixels) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(pixels)));
    std::vector<Point> points;
    for (std::size_t i = 0; i < side * side; ++i)
        if (i % 11 != 3)
            points.push_back(
                {0.1 * static_cast<double>(i / side), -0.1 * static_cast<double>(i % side)});
    return points;
}

}  // namespace

void check_changes(const Cloud& cloud) {
    const std::vector<Point> points = finite(cloud, 3000);
    std::thread other([&] { come_and_go(cloud, points); });
    come_and_go(cloud, points);
    other.join();
    const std::vector<Point> once = distinct(points), pixels = raster(points.size());
    std::thread second([&] { edges_come_and_go(cloud, once); });
    edges_come_and_go(cloud, points);
    second.join();
    std::thread third([&] { simplified(cloud, once); });
    simplified(cloud, once);
    third.join();
    simplified(cloud, pixels);
}

}  // namespace parallel
