// Heights, gradients, rasters, contours and rings of one surface, by one thread and by many; and
// two surfaces laid over each other.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "delaunay/locate.hpp"
#include "overlaid.hpp"
#include "patient.hpp"
#include "spoiler.hpp"
#include "surface/contours.hpp"
#include "surface/natural.hpp"
#include "surface/overlay.hpp"
#include "surface/passage.hpp"
#include "surface/relief.hpp"
#include "surface/rim.hpp"
#include "surface/sample.hpp"

namespace parallel {

namespace {

using liftmesh::Natural;
using liftmesh::Point;
using liftmesh::Threads;

constexpr std::size_t few = 200;

// A surface whose heights are a wave over its points, every third face left out.
struct Terrain {
    Terrain(const Cloud& cloud, const liftmesh::Delaunay& found)
        : mesh{cloud.input(), found.result.simplices.get(), found.result.neighbors.get(),
               found.result.triangle_count},
          heights(cloud.points.size()),
          left_out(mesh.count),
          relief(mesh, {reinterpret_cast<const std::byte*>(heights.data()), sizeof(Point)},
                 left_out.data()),
          locator(mesh, 20) {
        for (std::size_t i = 0; i < heights.size(); ++i)
            heights[i] = {std::sin(3 * cloud.points[i].x) + std::cos(5 * cloud.points[i].y), 0};
        for (std::size_t i = 0; i < mesh.count; i += 3) left_out[i] = 1;
    }

    liftmesh::Triangulated mesh;
    std::vector<Point> heights;  // with a neighbour, as strided columns have
    std::vector<std::uint8_t> left_out;
    liftmesh::Relief relief;
    liftmesh::Locator locator;
};

// What all calls give, in one list; empty if an interrupt came.
std::vector<double> answers(Terrain& terrain, const std::vector<Point>& asked, std::int32_t side,
                            Threads threads, liftmesh::Interrupt& interrupt) {
    const liftmesh::Queries queries{&asked[0].x, asked.size()};
    const auto pixels = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    std::vector<double> all(6 * asked.size() + 3 * pixels), levels{-1.5, -1, 0, 0.25, 1, 1.5};
    double* at = all.data();
    const auto next = [&at](std::size_t count) { return std::exchange(at, at + count); };
    const liftmesh::Grid grid{1.0 / side, 1e-4, 0, 1e-4, -1.0 / side, 1, 0, side, side};
    liftmesh::Contours lines;
    liftmesh::Rings found;
    bool done =
        sample_heights(terrain.relief, terrain.locator, queries, next(asked.size()), threads,
                       interrupt) &&
        sample_gradients(terrain.relief, terrain.locator, queries, next(2 * asked.size()), threads,
                         interrupt) &&
        scan_heights(terrain.relief, terrain.locator, grid, next(pixels), threads, interrupt) &&
        scan_gradients(terrain.relief, terrain.locator, grid, next(2 * pixels), threads,
                       interrupt) &&
        contours(terrain.relief, levels.data(), levels.size(), lines, threads, interrupt) &&
        rings(terrain.mesh, {terrain.left_out.data()}, found, interrupt);
    // On a circle all points are natural neighbours, so few are asked.
    const liftmesh::Queries some{queries.coordinates, std::min(queries.count, few)};
    for (const Natural method : {Natural::nearest, Natural::laplace, Natural::sibson})
        done = done && sample_natural(terrain.relief, terrain.locator, some, method,
                                      next(some.count), threads, interrupt);
    liftmesh::PointWeights shares;
    std::vector<std::int32_t> triangles(some.count);
    done = done && terrain.locator.find(some, triangles.data(), threads, interrupt) &&
           sample_weights(terrain.relief, terrain.locator, some, Natural::sibson, shares, threads,
                          interrupt);
    for (std::size_t i = 0; 2 * i < some.count; ++i) triangles[i] = triangles[2 * i];
    const liftmesh::Segments segments{queries.coordinates, triangles.data(), some.count / 2};
    liftmesh::Passages passages;
    done = done && find_passages(terrain.mesh, segments, passages, interrupt);
    if (!done) return {};
    all.insert(all.end(), passages.faces.begin(), passages.faces.end());
    all.insert(all.end(), shares.rows.begin(), shares.rows.end());
    all.insert(all.end(), shares.weights.begin(), shares.weights.end());
    const Point* const end = lines.points.get() + lines.starts.back();
    for (const Point* p = lines.points.get(); p != end; ++p) all.insert(all.end(), {p->x, p->y});
    all.insert(all.end(), found.rows.begin(), found.rows.end());
    return all;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

std::vector<Point> near(const Cloud& cloud, std::size_t most) {
    std::vector<Point> asked;
    for (std::size_t i = 0; i < cloud.points.size() && asked.size() < most; i += 7) {
        const Point p = cloud.points[i];
        asked.insert(asked.end(), {p, {1e-3 * p.x, 1e-3 * p.y}, {p.x + 1e-3, p.y}});
    }
    return asked;
}

void spoil(std::size_t rows, const Spoiling& by, std::size_t step, std::size_t moment,
           unsigned threads) {
    Cloud cloud = clouds(rows)[moment % 2];
    const std::vector<Point> asked = near(cloud, 300);  // exact arithmetic takes its time
    Patient patient;
    const liftmesh::Delaunay found =
        liftmesh::delaunay(cloud.input(), true, {threads, false}, patient);
    Terrain terrain(cloud, found);
    Spoiler of_points(cloud.points, by, step, moment),
        of_heights(terrain.heights, by, step, moment);
    answers(terrain, asked, 30, {threads, false}, of_points);
    answers(terrain, asked, 30, {threads, false}, of_heights);
    if (rows > few) return;  // each face may meet all others
    liftmesh::Between between{};
    liftmesh::between(terrain.relief, terrain.relief, 0, 0, between, of_points);
    const double part[] = {-0.5, -0.5, 1.5, 0, 0, 1.5};
    const std::int32_t first = 0;
    liftmesh::between_within(terrain.relief, terrain.relief, {part, &first, &first, 1}, between,
                             of_points);
}

}  // namespace

void check_surfaces(const Cloud& cloud, const liftmesh::Delaunay& found) {
    Terrain terrain(cloud, found);
    const std::vector<Point> asked = near(cloud, 20'000);
    const auto by = [&](unsigned threads, std::size_t patience) {
        Patient interrupt(patience);
        return answers(terrain, asked, 100, {threads, false}, interrupt);
    };
    const std::vector<double> alone = by(1, ~std::size_t{0});
    for (const unsigned threads : {2u, 5u}) {
        if (same(by(threads, ~std::size_t{0}), alone)) continue;
        std::fprintf(stderr, "FIND: %s: threads change a surface\n", cloud.name.c_str());
        std::exit(1);
    }
    for (const std::size_t patience : {1u, 3u, 8u, 20u, 40u}) by(3, patience);
}

void check_overlays(const Cloud& cloud) {
    const native::Overlaid surfaces(finite(cloud, 6000));
    const auto by = [&](unsigned threads, std::size_t patience) {
        Patient interrupt(patience);
        return surfaces.numbers({threads, false}, interrupt);
    };
    std::vector<double> other;
    std::thread caller([&] { other = by(3, ~std::size_t{0}); });
    const std::vector<double> alone = by(1, ~std::size_t{0});
    caller.join();
    demand(same(other, alone), cloud, "callers at the same time lay surfaces otherwise");
    for (const std::size_t patience : {1u, 2u, 4u, 8u, 16u, 64u}) by(3, patience);
}

void check_spoilt_surfaces(std::size_t rows, unsigned most_threads) {
    std::size_t runs = 0;
    for (const Spoiling& by : spoilings)
        for (const std::size_t step : {std::size_t{1}, std::size_t{13}})
            for (const std::size_t moment : {1, 5})
                for (unsigned threads = 1; threads <= most_threads; ++threads, ++runs) {
                    spoil(rows, by, step, moment, threads);
                    spoil(few, by, step, moment, threads);
                }
    std::printf("surfaces spoilt meanwhile: %zu runs\n", runs);
    std::fflush(stdout);
}

}  // namespace parallel
