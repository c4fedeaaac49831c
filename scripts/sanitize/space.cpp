#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <thread>
#include <vector>

#include "checks.hpp"
#include "patient.hpp"
#include "shapes.hpp"
#include "sphere/sphere.hpp"
#include "tetrahedra/locate.hpp"
#include "tetrahedra/tetrahedra.hpp"
#include "verify/sphere.hpp"
#include "verify/tetrahedra.hpp"

namespace parallel {

namespace {

using liftmesh::SpacePoint;
using liftmesh::Status;
using liftmesh::Tetrahedra;
using native::input_of;

// The rows at heights of few values, so that many are on spheres; where there are none, x.
std::vector<SpacePoint> raised(const Cloud& cloud) {
    std::mt19937_64 random(cloud.points.size());
    std::vector<SpacePoint> points;
    for (const liftmesh::Point p : cloud.points)
        points.push_back({p.x, p.y, static_cast<double>(random() % 64) / 64});
    return points;
}

Tetrahedra run(const std::vector<SpacePoint>& points, unsigned threads,
               std::size_t patience = ~std::size_t{0}) {
    Patient interrupt(patience);
    return liftmesh::tetrahedralize(input_of(points), true, threads, {threads, false}, interrupt);
}

bool same(const Tetrahedra& a, const Tetrahedra& b) {
    const std::size_t bytes = 4 * a.count * sizeof(std::int32_t);
    const auto equal = [&](const auto& x, const auto& y) {
        return bytes == 0 || std::memcmp(x.get(), y.get(), bytes) == 0;
    };
    return a.status == b.status && a.count == b.count && a.hull == b.hull &&
           equal(a.simplices, b.simplices) && equal(a.neighbors, b.neighbors);
}

void verified(const Cloud& cloud, const std::vector<SpacePoint>& points, const Tetrahedra& found) {
    for (const unsigned threads : {1u, 4u}) {
        Patient interrupt;
        const liftmesh::SpaceVerdict verdict =
            liftmesh::verify_tetrahedra(input_of(points), found.simplices.get(), found.count, true,
                                        {threads, false}, interrupt);
        demand(!verdict.flaws.any() && verdict.vertices == found.distinct, cloud,
               "the verifier finds flaws in tetrahedra");
    }
}

void located(const Cloud& cloud, const std::vector<SpacePoint>& points, const Tetrahedra& found) {
    const liftmesh::SpaceLocator locator(
        {points.data(), points.size(), found.simplices.get(), found.neighbors.get(), found.count});
    std::vector<std::int32_t> at(points.size());
    Patient interrupt;
    demand(locator.find(points.data(), points.size(), interrupt, at.data()), cloud,
           "a search in tetrahedra is interrupted");
    for (std::size_t row = 0; row < points.size(); ++row)
        demand((at[row] >= 0) == std::isfinite(points[row].x + points[row].y), cloud,
               "a row is in no tetrahedron");
}

// By two callers at the same time, then interrupted: numbers(secret, interrupt).
template <class Function>
void repeated(const Cloud& cloud, Function numbers) {
    const auto by = [&](std::uint64_t secret, std::size_t patience) {
        Patient interrupt(patience);
        return numbers(secret, interrupt);
    };
    native::Numbers other;
    std::thread caller([&] { other = by(1, ~std::size_t{0}); });
    const native::Numbers alone = by(2, ~std::size_t{0});
    caller.join();
    demand(!alone.empty() && other == alone, cloud, "callers at the same time differ in space");
    for (const std::size_t patience : {1u, 2u, 3u, 5u, 9u, 20u}) {
        const native::Numbers found = by(3, patience);
        demand(found.empty() || found == alone, cloud, "a run in space ends otherwise");
    }
}

template <int K, class Found>
void shaped(const Cloud& cloud, const std::vector<SpacePoint>& points, const Found& found,
            std::size_t count) {
    const liftmesh::SimplexView<K> view{points.data(), found.simplices.get(), found.neighbors.get(),
                                        count};
    repeated(cloud, [&](std::uint64_t, auto& interrupt) {
        return native::alpha_numbers(view, points.size(), interrupt);
    });
}

void shaped_in_the_plane(const Cloud& cloud, std::vector<SpacePoint> points) {
    liftmesh::NoInterrupt never;
    const liftmesh::Delaunay found = liftmesh::delaunay(cloud.input(), true, {}, never);
    if (found.status != Status::ok) return;
    repeated(cloud, [&](std::uint64_t, auto& interrupt) {
        return native::graph_numbers({cloud.input(), found.result.simplices.get(),
                                      found.result.neighbors.get(), found.result.triangle_count},
                                     interrupt);
    });
    for (SpacePoint& p : points) p.z = 0;
    shaped<3>(cloud, points, found.result, found.result.triangle_count);
}

// Seen from amid their heights.
void seen_on_a_sphere(const Cloud& cloud, std::vector<SpacePoint> points) {
    for (SpacePoint& p : points) p.z -= 0.5;
    points.resize(std::min<std::size_t>(points.size(), 5000));  // far off, exact signs are slow
    repeated(cloud, [&](std::uint64_t secret, auto& interrupt) {
        return native::sphere_numbers(points, secret, interrupt);
    });
}

// As rays, of which none is zero.
void check_sphere(const Cloud& cloud, std::vector<SpacePoint> rays) {
    for (SpacePoint& ray : rays) ++ray.z;
    Patient interrupt;
    const auto found = liftmesh::triangulate_sphere(input_of(rays), true, 1, interrupt);
    if (found.status != Status::ok) return;
    for (const unsigned threads : {1u, 4u}) {
        const liftmesh::SpaceVerdict verdict =
            liftmesh::verify_sphere(input_of(rays), found.simplices.front().data(),
                                    found.simplices.size(), true, {threads, false}, interrupt);
        demand(!verdict.flaws.any() && verdict.vertices == found.distinct, cloud,
               "the verifier finds flaws on the sphere");
    }
}

}  // namespace

void check_space(const Cloud& cloud) {
    const std::vector<SpacePoint> points = raised(cloud);
    check_sphere(cloud, points);
    const Tetrahedra alone = run(points, 1);
    for (const unsigned threads : {2u, 5u})
        demand(same(run(points, threads), alone), cloud, "threads change the tetrahedra");
    for (const std::size_t patience : {1u, 3u, 9u, 30u}) {
        const Tetrahedra found = run(points, 4, patience);
        demand(found.status == Status::interrupted || same(found, alone), cloud,
               "a run that could be interrupted comes to other tetrahedra");
    }
    if (alone.status != Status::ok) return;
    verified(cloud, points, alone);
    located(cloud, points, alone);
    shaped<4>(cloud, points, alone, alone.count);
    shaped_in_the_plane(cloud, points);
    seen_on_a_sphere(cloud, points);
}

}  // namespace parallel
