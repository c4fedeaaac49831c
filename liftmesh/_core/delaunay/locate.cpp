// A kd tree over a sample of the triangles leads to one near the query. From there a visibility
// walk crosses edges that separate the triangle from the query. In a Delaunay triangulation such a
// walk never returns to a triangle (Edelsbrunner 1990), and with exact orientations it ends at the
// right one.

#include "delaunay/locate.hpp"

#include <algorithm>
#include <bit>

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t simplices_per_cell = 8;

std::vector<Point> sample_corners(const Triangulated& triangulated, std::size_t wanted) {
    std::vector<Point> sample(wanted);
    for (std::size_t i = 0; i < wanted; ++i) {
        const std::size_t simplex = i * triangulated.count / wanted;
        sample[i] =
            triangulated.points[static_cast<std::size_t>(triangulated.simplices[3 * simplex])];
    }
    return sample;
}

int depth_for(std::size_t simplices) {
    return static_cast<int>(std::bit_width(simplices / simplices_per_cell + 1)) - 1;
}

}  // namespace

Locator::Locator(const Triangulated& triangulated)
    : triangulated_(triangulated),
      splitters_(sample_corners(triangulated, std::size_t{1} << depth_for(triangulated.count)),
                 depth_for(triangulated.count)),
      start_(splitters_.cells(), -1) {
    const std::size_t stride =
        std::max<std::size_t>(1, triangulated.count / (2 * splitters_.cells()));
    for (std::size_t simplex = 0; simplex < triangulated.count; simplex += stride) {
        const auto id = static_cast<std::int32_t>(simplex);
        start_[splitters_.cell(corner(id, 0))] = id;
    }
    // An empty cell starts where its predecessor does: in kd order they are neighbours.
    std::int32_t last = 0;
    for (std::int32_t& start : start_) last = start = start < 0 ? last : start;
}

std::int32_t Locator::find(Point p, Patience& patience) const {
    if (!is_finite(p)) return -1;
    const Found found = walk(p, patience);
    if (found.simplex < 0) return -1;
    int on = 0, edge = 0, off = 0;
    for (int k = 0; k < 3; ++k) {
        if (found.turn[k] == 0) {
            ++on;
            edge = k;
        } else {
            off = k;
        }
    }
    if (on == 0) return found.simplex;
    if (on == 2) return smallest_around(found.simplex, off, patience);
    const std::int32_t across = neighbor(found.simplex, edge);
    return across < 0 ? found.simplex : std::min(found.simplex, across);
}

Locator::Found Locator::walk(Point p, Patience& patience) const {
    Found found{start_[splitters_.cell(p)], {}};
    std::int32_t from = -1;
    // A walk that visits more triangles than there are means that the arrays were modified.
    for (std::size_t visited = 0; found.simplex >= 0; ++visited) {
        if (patience.ends() || visited > triangulated_.count) return {-1, {}};
        const Point corners[3] = {corner(found.simplex, 0), corner(found.simplex, 1),
                                  corner(found.simplex, 2)};
        int crossed = -1;
        for (int k = 0; k < 3 && crossed < 0; ++k) {
            const bool entered = from >= 0 && neighbor(found.simplex, k) == from;
            found.turn[k] = entered ? 1 : orient2d(corners[(k + 1) % 3], corners[(k + 2) % 3], p);
            if (found.turn[k] < 0) crossed = k;
        }
        if (crossed < 0) return found;
        from = found.simplex;
        found.simplex = neighbor(found.simplex, crossed);
    }
    return found;
}

// Visits the star of a vertex counter-clockwise and, if that reaches the hull, clockwise from the
// start.
std::int32_t Locator::smallest_around(std::int32_t simplex, int k, Patience& patience) const {
    const std::int32_t centre = vertex(simplex, k);
    std::int32_t smallest = simplex;
    for (const int turn : {1, 2}) {
        std::int32_t at = simplex;
        int place = k;
        while (!patience.ends()) {
            at = neighbor(at, (place + turn) % 3);
            if (at == simplex) return smallest;
            if (at < 0) break;
            smallest = std::min(smallest, at);
            for (place = 0; vertex(at, place) != centre;) ++place;
        }
    }
    return smallest;
}

}  // namespace liftmesh
