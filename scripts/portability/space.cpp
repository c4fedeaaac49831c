#include <vector>

#include "delaunay/delaunay.hpp"
#include "kinds.hpp"
#include "predicates/insphere.hpp"
#include "shapes.hpp"
#include "tetrahedra/tetrahedra.hpp"
#include "verify/tetrahedra.hpp"

namespace portability {

namespace {

using liftmesh::SpacePoint;
using liftmesh::Status;
using liftmesh::Tetrahedra;

constexpr std::size_t most_rows = 8000, most_questions = 200, most_directions = 1000;

// The height of a row is one coordinate of another.
std::vector<SpacePoint> raised(const double* coordinates, std::size_t rows) {
    std::vector<SpacePoint> points;
    for (std::size_t i = 0; i < std::min(rows, most_rows); ++i)
        points.push_back({coordinates[2 * i] + 0.0, coordinates[2 * i + 1] + 0.0,
                          coordinates[2 * (i * 7919 % rows) + i % 2] + 0.0});
    return points;
}

void add(Digest& digest, const native::Numbers& numbers) {
    if (!numbers.empty()) digest.add(numbers.data(), numbers.size() * sizeof(double));
}

void add_tetrahedra(const std::vector<SpacePoint>& points, Digests& digests) {
    Digest& digest = digests.of["tetrahedra"];
    const liftmesh::Input input = native::input_of(points);
    liftmesh::NoInterrupt never;
    const Tetrahedra found = liftmesh::tetrahedralize(input, true, 5, {}, never);
    digest.add(found.status);
    if (found.status != Status::ok) return;
    digest.add(found.simplices.get(), 4 * found.count * sizeof(std::int32_t));
    digest.add(found.neighbors.get(), 4 * found.count * sizeof(std::int32_t));
    digest.add(found.hull.data(), found.hull.size() * sizeof(found.hull[0]));
    const auto verdict = liftmesh::verify_tetrahedra(input, found.simplices.get(), found.count,
                                                     true, {3, false}, never);
    demand(!verdict.flaws.any(), "tetrahedra have flaws");
    const liftmesh::SimplexView<4> view{points.data(), found.simplices.get(), found.neighbors.get(),
                                        found.count};
    add(digests.of["alpha complexes"], native::alpha_numbers(view, points.size(), never));
}

void add_plane(std::vector<SpacePoint> points, Digests& digests) {
    for (SpacePoint& p : points) p.z = 0;
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay(native::input_of(points), true, {}, never);
    if (found.status != Status::ok) return;
    const liftmesh::SimplexView<3> view{points.data(), found.result.simplices.get(),
                                        found.result.neighbors.get(), found.result.triangle_count};
    add(digests.of["alpha complexes in the plane"],
        native::alpha_numbers(view, points.size(), never));
    const liftmesh::Triangulated mesh{native::input_of(points), view.simplices, view.neighbors,
                                      view.count};
    add(digests.of["graphs of near points"], native::graph_numbers(mesh, never));
}

void add_directions(std::vector<SpacePoint> points, Digest& digest) {
    points.resize(std::min(points.size(), most_directions));
    liftmesh::NoInterrupt never;
    add(digest, native::sphere_numbers(points, 7, never));
}

void add_signs(const std::vector<SpacePoint>& points, Digest& digest) {
    const auto is_finite = [](const SpacePoint& p) {
        return liftmesh::is_finite(p.planar()) && liftmesh::is_finite({p.z, 0});
    };
    for (std::size_t i = 0; i + 5 <= points.size() && i < most_questions; ++i) {
        const SpacePoint* p = &points[i];
        if (!std::all_of(p, p + 5, is_finite)) continue;
        const SpacePoint five[5] = {p[0], p[1], p[2], p[3], p[4]};
        digest.add(liftmesh::volume_sign(p[0], p[1], p[2], p[3], {}));
        digest.add(liftmesh::insphere_exact(five, {}));
        digest.add(liftmesh::insphere_canonical_exact(five, {}));
    }
}

}  // namespace

void add_space(const double* coordinates, std::size_t rows, Digests& digests) {
    const std::vector<SpacePoint> points = raised(coordinates, rows);
    add_tetrahedra(points, digests);
    add_plane(points, digests);
    add_directions(points, digests.of["on the sphere"]);
    add_signs(points, digests.of["signs in space"]);
}

}  // namespace portability
