#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "kinds.hpp"
#include "overlaid.hpp"
#include "rows.hpp"
#include "surface/contours.hpp"
#include "surface/natural.hpp"
#include "surface/overlay.hpp"
#include "surface/passage.hpp"
#include "surface/relief.hpp"
#include "surface/rim.hpp"
#include "surface/sample.hpp"

namespace portability {

namespace {

using liftmesh::Natural;
using liftmesh::Point;
using liftmesh::Threads;

constexpr std::size_t most_asked = 2000, most_near = 60, most_overlaid = 1500;
constexpr Threads three{3, false};

// Which NaN it is differs between processors.
void add(Digest& digest, const std::vector<double>& values) {
    for (const double value : values)
        digest.add(std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value);
}

template <class T>
void add(Digest& digest, const std::vector<T>& values) {
    if (!values.empty()) digest.add(values.data(), values.size() * sizeof(T));
}

// Heights by sums, products and quotients alone; every fifth face is left out.
struct Terrain {
    Terrain(const double* coordinates, std::size_t rows, const liftmesh::Delaunay& found)
        : mesh{native::input_of(coordinates, rows), found.result.simplices.get(),
               found.result.neighbors.get(), found.result.triangle_count},
          heights(rows),
          lowered(rows),
          left_out(mesh.count),
          relief(mesh, {reinterpret_cast<const std::byte*>(heights.data()), sizeof(double)},
                 left_out.data()),
          locator(mesh, 20) {
        for (std::size_t i = 0; i < rows; ++i) {
            heights[i] = static_cast<double>(i * 2654435761 % 4096) / 64;
            lowered[i] = heights[i] - 3 + static_cast<double>(i % 7);
        }
        for (std::size_t i = 0; i < mesh.count; i += 5) left_out[i] = 1;
    }

    liftmesh::Triangulated mesh;
    std::vector<double> heights, lowered;
    std::vector<std::uint8_t> left_out;
    liftmesh::Relief relief;
    liftmesh::Locator locator;
};

// Rows, and points between two of them.
std::vector<Point> asked_of(const double* coordinates, std::size_t rows) {
    std::vector<Point> asked;
    const std::size_t step = rows / (most_asked / 2) + 1;
    for (std::size_t i = 0; i < rows; i += step) {
        const std::size_t j = (i * 48271 + 1) % rows;
        const Point p{coordinates[2 * i], coordinates[2 * i + 1]};
        asked.insert(
            asked.end(),
            {p, {0.5 * p.x + 0.5 * coordinates[2 * j], 0.5 * p.y + 0.5 * coordinates[2 * j + 1]}});
    }
    return asked;
}

void add_points(Terrain& terrain, const std::vector<Point>& asked, Digests& digests) {
    liftmesh::NoInterrupt never;
    const liftmesh::Queries queries{&asked[0].x, asked.size()};
    std::vector<double> heights(asked.size()), gradients(2 * asked.size());
    std::vector<std::int32_t> owners(asked.size());
    sample_heights(terrain.relief, terrain.locator, queries, heights.data(), {}, never);
    sample_gradients(terrain.relief, terrain.locator, queries, gradients.data(), {}, never);
    sample_owners(terrain.relief, terrain.locator, queries, owners.data(), {}, never);
    add(digests.of["heights"], heights);
    add(digests.of["gradients"], gradients);
    add(digests.of["owners"], owners);
}

void add_natural(Terrain& terrain, const std::vector<Point>& asked, Digests& digests) {
    liftmesh::NoInterrupt never;
    const liftmesh::Queries queries{&asked[0].x, std::min(asked.size(), most_near)};
    constexpr const char* names[] = {"linear", "nearest", "nearest beyond", "Laplace", "Sibson"};
    for (const Natural method : {Natural::nearest, Natural::laplace, Natural::sibson}) {
        std::vector<double> found(queries.count);
        sample_natural(terrain.relief, terrain.locator, queries, method, found.data(), {}, never);
        add(digests.of[names[static_cast<std::size_t>(method)]], found);
    }
    std::vector<std::int32_t> at(queries.count);
    liftmesh::PointWeights shares;
    terrain.locator.find(queries, at.data(), {}, never);
    sample_weights(terrain.relief, terrain.locator, queries, Natural::sibson, shares, {}, never);
    for (std::size_t i = 0; 2 * i < at.size(); ++i) at[i] = at[2 * i];
    liftmesh::Passages passages;
    find_passages(terrain.mesh, {queries.coordinates, at.data(), queries.count / 2}, passages,
                  never);
    add(digests.of["passages"], passages.faces);
    add(digests.of["natural weights"], shares.rows);
    add(digests.of["natural weights"], shares.weights);
}

// A raster over the box of the points, turned by the ratio 3 : 4.
void add_raster(Terrain& terrain, const std::vector<Point>& asked, Digests& digests) {
    Point low = asked[0], high = asked[0];
    for (const Point p : asked) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    constexpr std::int32_t side = 60;
    const double x = (high.x - low.x) / side, y = (high.y - low.y) / side;
    const liftmesh::Grid grid{0.8 * x, 0.6 * x, low.x, -0.6 * y, 0.8 * y, low.y + 0.5 * side * y,
                              0,       side,    side};
    if (!std::isfinite(grid.largest()) || grid.a * grid.e - grid.b * grid.d == 0) return;
    liftmesh::NoInterrupt never;
    std::vector<double> heights(grid.pixels()), again(grid.pixels()), gradients(2 * grid.pixels());
    std::vector<float> singles(grid.pixels());
    std::vector<std::int32_t> owners(grid.pixels());
    scan_heights(terrain.relief, terrain.locator, grid, heights.data(), {}, never);
    scan_heights(terrain.relief, terrain.locator, grid, again.data(), three, never);
    demand(std::memcmp(heights.data(), again.data(), 8 * grid.pixels()) == 0, "threads differ");
    scan_heights(terrain.relief, terrain.locator, grid, singles.data(), {}, never);
    scan_gradients(terrain.relief, terrain.locator, grid, gradients.data(), {}, never);
    scan_owners(terrain.relief, terrain.locator, grid, owners.data(), {}, never);
    Digest& digest = digests.of["rasters"];
    add(digest, heights);
    add(digest, std::vector<double>(singles.begin(), singles.end()));
    add(digest, gradients);
    add(digest, owners);
}

void add_lines(Terrain& terrain, Digests& digests) {
    liftmesh::NoInterrupt never;
    const std::vector<double> levels{1, 7.5, 31, 32, 50.25};
    liftmesh::Contours lines;
    contours(terrain.relief, levels.data(), levels.size(), lines, {}, never);
    Digest& digest = digests.of["contours"];
    const Point* const end = lines.points.get() + lines.starts.back();
    for (const Point* p = lines.points.get(); p != end; ++p)
        add(digest, std::vector<double>{p->x, p->y});
    add(digest, lines.starts);
    add(digest, lines.levels);
    add(digest, lines.is_closed);
    liftmesh::Rings found;
    rings(terrain.mesh, {terrain.left_out.data()}, found, never);
    add(digests.of["rings"], found.rows);
    add(digests.of["rings"], found.starts);
}

void add_volumes(Terrain& terrain, Digests& digests) {
    liftmesh::NoInterrupt never;
    const liftmesh::Relief lowered(
        terrain.mesh, {reinterpret_cast<const std::byte*>(terrain.lowered.data()), sizeof(double)},
        nullptr);
    double corners[6];
    for (int k = 0; k < 3; ++k) {
        const Point p = terrain.mesh.corner(1, k);
        corners[2 * k] = p.x;
        corners[2 * k + 1] = p.y;
    }
    const std::int32_t face = 1;
    liftmesh::Between whole{}, part{};
    between(terrain.relief, lowered, 0, 0, whole, never);
    between_within(terrain.relief, lowered, {corners, &face, &face, 1}, part, never);
    for (const liftmesh::Between& each : {whole, part})
        add(digests.of["volumes"], std::vector<double>{each.above, each.below, each.area});
}

void add_overlay(const double* coordinates, std::size_t rows, Digests& digests) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < std::min(rows, most_overlaid); ++i)
        if (const Point p{coordinates[2 * i] + 0.0, coordinates[2 * i + 1] + 0.0};
            liftmesh::is_finite(p))
            points.push_back(p);
    liftmesh::NoInterrupt never;
    add(digests.of["overlays"], native::Overlaid(points).numbers({}, never));
}

}  // namespace

void add_surfaces(const double* coordinates, std::size_t rows, Digests& digests) {
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay(native::input_of(coordinates, rows), true, {}, never);
    if (found.status != liftmesh::Status::ok) return;
    Terrain terrain(coordinates, rows, found);
    const std::vector<Point> asked = asked_of(coordinates, rows);
    add_points(terrain, asked, digests);
    add_natural(terrain, asked, digests);
    add_raster(terrain, asked, digests);
    add_lines(terrain, digests);
    add_overlay(coordinates, rows, digests);
    if (rows <= most_overlaid && terrain.mesh.count > 1) add_volumes(terrain, digests);
}

}  // namespace portability
