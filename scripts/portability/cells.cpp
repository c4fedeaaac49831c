#include "cells.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "cells/clip.hpp"
#include "cells/diagram.hpp"
#include "delaunay/delaunay.hpp"
#include "rows.hpp"

namespace portability {

namespace {

using liftmesh::Dual;
using liftmesh::Point;

constexpr Dual::Kind kinds[] = {Dual::Kind::plain, Dual::Kind::weights, Dual::Kind::radii};
constexpr const char* names[] = {"Voronoi vertices", "vertices by weight", "vertices by radius"};

template <class T>
void add(Digest& digest, const T* values, std::size_t count) {
    if (count > 0) digest.add(values, count * sizeof(T));
}

void add_regions(const Dual& dual, const std::int32_t* vertex_of, Digest& digest) {
    liftmesh::NoInterrupt never;
    liftmesh::Regions made;
    demand(liftmesh::make_regions(dual, vertex_of, never, made), "interrupted regions");
    add(digest, made.ridge_sites.get(), 2 * made.ridge_count);
    add(digest, made.ridge_ends.get(), 2 * made.ridge_count);
    add(digest, made.region_of.get(), dual.rows);
    add(digest, made.starts.get(), made.region_count + 1);
    add(digest, made.corners.get(), 2 * made.ridge_count);
}

// The corners of a square in the middle of the points; none if they are too near to each other.
std::vector<Point> square(const Dual& dual) {
    Point low = dual.points[0], high = low;
    for (std::size_t i = 0; i < dual.rows; ++i) {
        low = {std::min(low.x, dual.points[i].x), std::min(low.y, dual.points[i].y)};
        high = {std::max(high.x, dual.points[i].x), std::max(high.y, dual.points[i].y)};
    }
    const double x = 0.5 * low.x + 0.5 * high.x, y = 0.5 * low.y + 0.5 * high.y;
    const double reach = std::max(0.25 * high.x - 0.25 * low.x, 0.25 * high.y - 0.25 * low.y);
    const Point first{x - reach, y - reach}, last{x + reach, y + reach};
    if (!(first.x < x && x < last.x && first.y < y && y < last.y)) return {};
    return {{first.x, y}, {x, first.y}, {last.x, y}, {x, last.y}};
}

void add_clipped(const Dual& dual, const std::int32_t* vertex_of, Digest& digest) {
    const std::vector<Point> corners = square(dual);
    if (corners.empty()) return;
    const std::int32_t starts[] = {0, static_cast<std::int32_t>(corners.size())};
    liftmesh::NoInterrupt never;
    liftmesh::Clipped made;
    const liftmesh::Spokes spokes(dual, nullptr, 0);
    const auto outcome =
        liftmesh::clip(dual, vertex_of, spokes, {corners.data(), starts, 1}, never, made);
    demand(outcome == liftmesh::Clipping::done, "a square that is not simple");
    add(digest, made.corners.data(), made.corners.size());
    // Others are rough, maybe not numbers: the caller computes them exactly.
    for (std::size_t i = 0; i < made.points.size(); ++i)
        if (made.certain[i]) add(digest, &made.points[i], 1);
    add(digest, made.starts.data(), made.starts.size());
    add(digest, made.cells.data(), made.cells.size());
}

}  // namespace

// Values are the second coordinates of the next rows.
void add_cells(const double* coordinates, std::size_t rows, Digests& digests) {
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay(native::input_of(coordinates, rows), true, {}, never);
    if (found.status != liftmesh::Status::ok) return;
    std::vector<Point> points;
    std::vector<double> values;
    for (std::size_t i = 0; i < rows; ++i) {
        points.push_back({coordinates[2 * i], coordinates[2 * i + 1]});
        values.push_back(std::fabs(coordinates[2 * ((i + 1) % rows) + 1]));
    }
    for (int i = 0; i < 3; ++i) {
        const Dual dual{points.data(),
                        values.data(),
                        kinds[i],
                        rows,
                        found.result.simplices.get(),
                        found.result.neighbors.get(),
                        found.result.triangle_count};
        liftmesh::Vertices made;
        demand(liftmesh::make_vertices(dual, {}, never, made), "interrupted vertices");
        add(digests.of[names[i]], made.points.get(), made.count);
        add(digests.of[names[i]], made.of.get(), dual.count);
        if (i > 0) continue;
        add_regions(dual, made.of.get(), digests.of["regions"]);
        add_clipped(dual, made.of.get(), digests.of["clipped cells"]);
    }
}

}  // namespace portability
