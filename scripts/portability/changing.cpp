#include <algorithm>
#include <vector>

#include "changing_edges.hpp"
#include "dynamic/triangulation.hpp"
#include "kinds.hpp"
#include "simplification/simplify.hpp"

namespace portability {

namespace {

using liftmesh::Point;
using liftmesh::Vertex;
using liftmesh::simplification::Simplified;
using liftmesh::simplification::Terrain;

constexpr std::size_t most_changing = 900;

std::vector<Point> finite(const double* coordinates, std::size_t rows) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < rows && points.size() < most_changing; ++i)
        if (const Point p{coordinates[2 * i] + 0.0, coordinates[2 * i + 1] + 0.0};
            liftmesh::is_finite(p))
            points.push_back(p);
    return points;
}

void add(Digest& digest, const liftmesh::dynamic::Triangulation& mesh) {
    const liftmesh::Result found = mesh.result();
    const std::size_t corners = 3 * found.triangle_count;
    digest.add(mesh.size());
    if (corners == 0) return;
    digest.add(found.simplices.get(), corners * sizeof(std::int32_t));
    digest.add(found.neighbors.get(), corners * sizeof(std::int32_t));
    digest.add(found.hull.get(), found.hull_count * sizeof(std::int32_t));
}

// One by one, then at once, then some go, one by one and at once, and come again.
void add_sequence(const std::vector<Point>& points, Digest& digest) {
    liftmesh::NoInterrupt never;
    liftmesh::dynamic::Triangulation mesh;
    std::vector<Vertex> found(points.size());
    const std::size_t half = points.size() / 2;
    for (std::size_t i = 0; i < half; ++i) found[i] = mesh.insert(points[i]);
    add(digest, mesh);
    const std::vector<Point> rest(points.begin() + static_cast<std::ptrdiff_t>(half), points.end());
    mesh.insert(liftmesh::dynamic::input_of(rest), found.data() + half, never);
    add(digest, mesh);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<Vertex> gone;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (i % 3 == 0) mesh.remove(found[i]);
        if (i % 3 == 1) gone.push_back(found[i]);
    }
    add(digest, mesh);
    mesh.remove(gone.data(), gone.size(), never);
    add(digest, mesh);
    for (std::size_t i = 0; i < points.size(); i += 2) mesh.insert(points[i]);
    add(digest, mesh);
}

// With constraints, some of which go before others.
void add_edges(const std::vector<Point>& points, Digest& digest) {
    native::change_edges(points, [&](const liftmesh::dynamic::Triangulation& mesh) {
        add(digest, mesh);
        for (const auto& [a, b] : mesh.constraints().wholes()) {
            digest.add(a);
            digest.add(b);
        }
        for (const auto mark : mesh.marks()) digest.add(mark);
    });
}

void add_rows(const Simplified& found, Digest& digest) {
    digest.add(found.status);
    digest.add(found.is_within);
    digest.add(found.inserted);
    for (const liftmesh::Row row : found.rows) digest.add(row);
}

void add_simplified(const std::vector<Point>& points, Digest& digest) {
    liftmesh::NoInterrupt never;
    const auto whole = liftmesh::delaunay(liftmesh::dynamic::input_of(points), false, {}, never);
    if (whole.status != liftmesh::Status::ok) return;
    std::vector<double> heights;
    for (std::size_t i = 0; i < points.size(); ++i)
        heights.push_back(static_cast<double>(i * 2654435761 % 64) / 8 +
                          static_cast<double>(i % 29));
    const Terrain terrain{points.data(), heights.data(), points.size(), whole.result.hull.get(),
                          whole.result.hull_count};
    for (const double tolerance : {0.0, 2.0, 9.0})
        add_rows(liftmesh::simplification::simplify(terrain, tolerance, 0, true, never), digest);
    add_rows(liftmesh::simplification::simplify(terrain, 1, points.size() / 4, false, never),
             digest);
    add_rows(liftmesh::simplification::thin(terrain, points.size() / 3, never), digest);
    std::vector<std::int32_t> edges;  // of the triangulation: none cross
    for (std::size_t i = 0; i < 3 * whole.result.triangle_count; i += 21)
        edges.insert(edges.end(), {whole.result.simplices[i], whole.result.simplices[i + 1]});
    Terrain followed = terrain;
    followed.edges = edges.data();
    followed.edge_count = edges.size() / 2;
    add_rows(liftmesh::simplification::simplify(followed, 2, 0, true, never), digest);
}

// On lattices, rasters; elsewhere clouds.
std::vector<Point> distinct(std::vector<Point> points) {
    std::sort(points.begin(), points.end(), liftmesh::before_xy);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

}  // namespace

void add_changes(const double* coordinates, std::size_t rows, Digests& digests) {
    const std::vector<Point> points = finite(coordinates, rows);
    add_sequence(points, digests.of["points that come and go"]);
    add_edges(points, digests.of["edges that come and go"]);
    add_simplified(distinct(points), digests.of["simplified"]);
    std::vector<Point> raster;  // of a step that no double holds
    for (std::size_t i = 0; i < points.size(); ++i)
        raster.push_back({0.1 * static_cast<double>(i / 30), 0.1 * static_cast<double>(i % 30)});
    add_simplified(raster, digests.of["simplified"]);
}

}  // namespace portability
