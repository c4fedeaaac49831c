#include <algorithm>

#include "kinds.hpp"
#include "predicates/determinants.hpp"
#include "predicates/distances.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/orient3d.hpp"
#include "predicates/seen_from_base.hpp"

namespace portability {

namespace {

using liftmesh::Guard;
using liftmesh::Point;
using liftmesh::SpacePoint;

constexpr std::size_t most_questions = 500;

void add_signs(Point a, Point b, Point c, Point d, Digest& digest) {
    digest.add(liftmesh::orient2d(a, b, c));
    digest.add(liftmesh::incircle_exact(a, b, c, d, Guard::anywhere()));
    digest.add(liftmesh::incircle_canonical_exact(a, b, c, d, Guard::anywhere()));
    digest.add(liftmesh::compare_distances(a, b, c, d));
    digest.add(liftmesh::sign_at_apex(a, b, c));
    digest.add(liftmesh::do_circles_cross(a, b, c, d));
    digest.add(liftmesh::distance(a, b));
    digest.add(liftmesh::turn_in_oyz(a, b, c, d));
    const SpacePoint p{a.x, a.y, b.x}, q{b.x, b.y, c.x}, r{c.x, c.y, d.x}, s{d.x, d.y, a.x};
    digest.add(liftmesh::orient3d_exact(p, q, r, s));
}

// Of numbers within the filters' window only: others overflow, and the sign of a NaN, which the
// standard leaves open, differs between processors.
void add_filters(Point a, Point b, Point c, Point d, Digest& digest) {
    for (const Point p : {a, b, c, d})
        if (!(std::fabs(p.x) < 1e60 && std::fabs(p.y) < 1e60)) return;
    const liftmesh::InCircleFilter filter = liftmesh::incircle_filter(a, b, c, d);
    digest.add(filter.det);
    digest.add(filter.error);
    const liftmesh::Base base(liftmesh::Paraboloid{}, liftmesh::pair(a), liftmesh::pair(b));
    const liftmesh::Pair of_c = liftmesh::pair(c), of_d = liftmesh::pair(d);
    digest.add(liftmesh::below(base.place(of_c), base.place(of_d)));
    digest.add(liftmesh::error_of_below<liftmesh::Paraboloid>(base.bound(of_c), base.bound(of_d)));
}

}  // namespace

void add_signs(const double* coordinates, std::size_t rows, Digests& digests) {
    const auto row = [&](std::size_t i) {
        return Point{coordinates[2 * (i % rows)] + 0.0, coordinates[2 * (i % rows) + 1] + 0.0};
    };
    for (std::size_t i = 0; i < std::min(rows, most_questions); ++i) {
        add_signs(row(i), row(i + 1), row(i + 2), row(i + 3), digests.of["signs"]);
        add_filters(row(i), row(i + 1), row(i + 2), row(i + 3), digests.of["filters"]);
    }
}

}  // namespace portability
