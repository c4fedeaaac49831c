// Two small surfaces laid over each other: whether the overlay is a triangulation inside of faces
// of both, whose volumes are those that are measured without it, and which nothing but the surfaces
// decides.
#include "surface/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "ground.hpp"
#include "sorting/triangle_order.hpp"
#include "surface/overlay_mesh.hpp"
#include "targets.hpp"

namespace fuzzing {

namespace {

using liftmesh::OverlayMesh;

constexpr std::size_t most_points = 24;

// As laying over takes surfaces that nearly coincide: units in the last place of a coordinate.
constexpr double units_for_rounding = 512;

// A scatter, the same with a few others, or others in its place.
Scatter beside(const Scatter& at, Bytes& bytes) {
    const unsigned kind = bytes.byte();
    Scatter found = scatter(bytes, most_points);
    if (kind % 4 == 0) return found;
    Scatter some;
    for (std::size_t i = kind % 2; i < at.size(); i += 1 + kind % 3) {
        some.points.push_back(at.points[i]);
        some.heights.push_back(kind % 8 < 4 ? at.heights[i] : at.heights[i] / 2 + 1);
    }
    for (std::size_t i = 0; i < found.size() && kind % 4 != 1; ++i) {
        if (std::find(some.points.begin(), some.points.end(), found.points[i]) != some.points.end())
            continue;
        some.points.push_back(found.points[i]);
        some.heights.push_back(found.heights[i]);
    }
    return some;
}

bool touch(const Ground& one, std::int32_t face, const Ground& two, std::int32_t other) {
    const auto is_apart = [](const Ground& a, std::int32_t f, const Ground& b, std::int32_t g) {
        for (int side = 0; side < 3; ++side) {
            int beyond = 0;
            for (int k = 0; k < 3; ++k)
                beyond += fuzzing::turn(a.mesh.corner(f, side), a.mesh.corner(f, (side + 1) % 3),
                                        b.mesh.corner(g, k)) < 0;
            if (beyond == 3) return true;
        }
        return false;
    };
    return !is_apart(one, face, two, other) && !is_apart(two, other, one, face);
}

// All pairs of faces that touch.
std::vector<std::pair<std::int32_t, std::int32_t>> pairs(const Ground& one, const Ground& two) {
    std::vector<std::pair<std::int32_t, std::int32_t>> found;
    for (std::int32_t face = 0; face < one.count(); ++face)
        for (std::int32_t other = 0; other < two.count(); ++other)
            if (touch(one, face, two, other)) found.emplace_back(face, other);
    return found;
}

OverlayMesh laid(const Ground& one, const Ground& two, std::pair<std::int32_t, std::int32_t> from) {
    OverlayMesh found;
    Impatient interrupt;
    demand(overlay_mesh(one.relief, two.relief, from.first, from.second, found, {}, interrupt),
           "an overlay ends early");
    return found;
}

// Corners and constrained sides of all triangles, in canonical order.
std::vector<std::int32_t> triangles(const OverlayMesh& mesh) {
    liftmesh::NoInterrupt never;
    liftmesh::ThreadPool alone({}, never);
    liftmesh::OrderedTriangles ordered;
    liftmesh::order_triangles(
        {mesh.simplices.get(), mesh.neighbors.get(), mesh.bits.get(), mesh.triangles}, nullptr,
        mesh.rows, ordered, alone);
    const std::size_t corners = 3 * mesh.triangles;
    std::vector<std::int32_t> all(ordered.simplices.get(), ordered.simplices.get() + corners);
    all.insert(all.end(), ordered.neighbors.get(), ordered.neighbors.get() + corners);
    all.insert(all.end(), ordered.bits.get(), ordered.bits.get() + mesh.triangles);
    return all;
}

void demand_same(const OverlayMesh& a, const OverlayMesh& b, double sign, const char* what) {
    demand(a.is_sound == b.is_sound, what);
    if (!a.is_sound) return;
    demand(a.rows == b.rows && a.triangles == b.triangles && a.crossings == b.crossings, what);
    for (std::size_t row = 0; row < a.rows; ++row)
        demand(a.points[row] == b.points[row] &&
                   (a.rises[row] == sign * b.rises[row] || std::isnan(a.rises[row])),
               what);
    demand(triangles(a) == triangles(b), what);
}

double largest(const Scatter& at) {
    double found = 0;
    for (const Point p : at.points) found = std::max({found, std::fabs(p.x), std::fabs(p.y)});
    return found;
}

// Whether all corners are in a face that is shown, but for rounding.
bool is_inside(const Ground& ground, const Point (&corners)[3], double rounding) {
    for (std::int32_t face = 0; face < ground.count(); ++face) {
        bool is_in = ground.relief.is_shown(face);
        for (int side = 0; side < 3 && is_in; ++side) {
            const Point tail = ground.mesh.corner(face, side),
                        head = ground.mesh.corner(face, (side + 1) % 3);
            const long double x = head.x - static_cast<long double>(tail.x),
                              y = head.y - static_cast<long double>(tail.y);
            for (const Point p : corners)
                is_in = is_in && x * (p.y - static_cast<long double>(tail.y)) -
                                         y * (p.x - static_cast<long double>(tail.x)) >=
                                     -rounding * (std::fabs(x) + std::fabs(y));
        }
        if (is_in) return true;
    }
    return false;
}

void check_mesh(const OverlayMesh& mesh, const Ground& one, const Ground& two, double rounding) {
    for (std::size_t row = 1; row < mesh.rows; ++row)
        demand(before_xy(mesh.points[row - 1], mesh.points[row]), "rows are not in order");
    const auto corner = [&](std::size_t place) {
        return mesh.points[static_cast<std::size_t>(mesh.simplices[place])];
    };
    for (std::size_t place = 0; place < 3 * mesh.triangles; ++place) {
        const std::size_t t = place - place % 3;
        const std::int32_t beyond = mesh.neighbors[place];
        bool is_linked = beyond < 0;
        for (std::size_t k = 0; k < 3 && !is_linked; ++k)
            is_linked = mesh.neighbors[3 * static_cast<std::size_t>(beyond) + k] ==
                        static_cast<std::int32_t>(t / 3);
        demand(is_linked, "a side is not linked from beyond");
        if (place != t) continue;
        const Point corners[3] = {corner(t), corner(t + 1), corner(t + 2)};
        demand(fuzzing::turn(corners[0], corners[1], corners[2]) > 0,
               "a triangle is not turned left");
        demand(is_inside(one, corners, rounding) && is_inside(two, corners, rounding),
               "a triangle is in no face of one surface");
    }
}

// Whether no two positions are as near to each other as what counts as being at one place: it has
// one height.
bool are_apart(const Scatter& at, const Scatter& over, double rounding) {
    std::vector<Point> all = at.points;
    all.insert(all.end(), over.points.begin(), over.points.end());
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (!(all[i] == all[j]) && std::max(std::fabs(all[i].x - all[j].x),
                                                std::fabs(all[i].y - all[j].y)) <= rounding)
                return false;
    return true;
}

// The rise at a vertex of both is the difference of their heights.
void check_rises(const OverlayMesh& mesh, const Ground& one, const Ground& two) {
    for (std::size_t i = 0; i < one.at.size(); ++i) {
        const Point place = one.at.points[i];
        const auto& others = two.at.points;
        const auto same = std::find(others.begin(), others.end(), place);
        if (same == others.end()) continue;
        const auto k = static_cast<std::size_t>(same - others.begin());
        const double rise = one.at.heights[i] - two.at.heights[k];
        for (std::size_t row = 0; row < mesh.rows; ++row)
            demand(!(mesh.points[row] == place) || mesh.rises[row] == rise || !std::isfinite(rise),
                   "a vertex of both has another rise");
    }
}

// Against those that are measured in pairs of faces, without an overlay.
void check_volumes(const OverlayMesh& mesh, const Ground& one, const Ground& two,
                   std::pair<std::int32_t, std::int32_t> from, double rounding, double reach) {
    liftmesh::Between found{};
    Impatient interrupt;
    demand(between(one.relief, two.relief, from.first, from.second, found, interrupt),
           "volumes end early");
    long double area = 0, net = 0, highest = 0;
    for (std::size_t t = 0; t < 3 * mesh.triangles; t += 3) {
        Point at[3];
        long double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto row = static_cast<std::size_t>(mesh.simplices[t + k]);
            at[k] = mesh.points[row];
            sum += mesh.rises[row];
            highest = std::max(highest, std::fabs(static_cast<long double>(mesh.rises[row])));
        }
        const long double x = at[1].x - static_cast<long double>(at[0].x),
                          y = at[1].y - static_cast<long double>(at[0].y);
        const long double own = (x * (at[2].y - static_cast<long double>(at[0].y)) -
                                 y * (at[2].x - static_cast<long double>(at[0].x))) /
                                2;
        area += own;
        net += own * sum / 3;
    }
    const long double close = static_cast<long double>(rounding) * reach * 64;
    demand(std::fabs(area - found.area) <= close, "the overlay has another area");
    // From `between` a volume is of the second over the first.
    demand(std::fabs(net + (found.above - found.below)) <=
               close * (highest + 1) * 1024 + std::fabs(net) * 0x1p-30L,
           "the overlay has another volume");
}

}  // namespace

void check_overlay(Bytes bytes) {
    const unsigned what = bytes.byte(), leaves_out = bytes.byte() % 6;
    const Scatter at =
        what % 4 == 0 ? turned_scatter(bytes, most_points) : scatter(bytes, most_points);
    const Scatter over = beside(at, bytes);
    Impatient interrupt;
    const auto found = liftmesh::delaunay(at.input(), false, {}, interrupt),
               second = liftmesh::delaunay(over.input(), false, {}, interrupt);
    if (found.status != liftmesh::Status::ok || second.status != liftmesh::Status::ok) return;
    Dice dice(what + at.size());
    const Scatter mixed = at.in_order(shuffled(at.size(), dice));
    const auto again = liftmesh::delaunay(mixed.input(), false, {}, interrupt);
    const Ground one(at, found, leaves_out), two(over, second, leaves_out / 2),
        other(mixed, again, leaves_out);
    const auto starts = pairs(one, two);
    if (starts.empty()) return;
    const OverlayMesh mesh = laid(one, two, starts[0]);
    const auto turned = std::pair(starts.back().second, starts.back().first);
    demand_same(mesh, laid(two, one, turned), -1, "exchanged surfaces differ in more than signs");
    demand_same(mesh, laid(other, two, pairs(other, two).back()), 1,
                "the order of rows changes an overlay");
    if (!mesh.is_sound || mesh.triangles == 0) return;
    const double reach = std::max(largest(at), largest(over));
    const double rounding = units_for_rounding * 0x1p-52 * reach;
    check_mesh(mesh, one, two, rounding);
    if (!are_apart(at, over, rounding)) return;
    check_rises(mesh, one, two);
    const bool are_tame = !at.is_wide && !over.is_wide && reach < 0x1p100 && reach > 0x1p-100;
    if (are_tame) check_volumes(mesh, one, two, starts[0], rounding, reach);
}

}  // namespace fuzzing
