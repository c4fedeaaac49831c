// Disks, and metrics for each point: graphs that the verifier accepts, and no others; stars that
// are those of the triangulation in the metric of their point.
#include <algorithm>
#include <cmath>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "disk_arrays.hpp"
#include "stars.hpp"

namespace fuzzing {

namespace {

using liftmesh::DiskFlaw;
using liftmesh::Point;
using liftmesh::anisotropic::Metric;
using liftmesh::apollonius::Disk;
using liftmesh::apollonius::Signs;
using native::DiskArrays;

constexpr std::size_t most_disks = 24, most_stars = 6;

std::vector<Point> some_points(Case& c, const Rows& rows, std::size_t most) {
    std::vector<Point> points;
    for (const liftmesh::Row row : rows)
        if (points.size() < most) points.push_back(c.point(row));
    for (Point& p : points) p = {p.x + 0.0, p.y + 0.0};
    return points;
}

// Radii of the size of distances: to other points along an axis, whole or in part, or 0. Some disks
// occur twice, and some are in others.
std::vector<Disk> disks_of(Case& c, const Rows& rows) {
    const std::vector<Point> points = some_points(c, rows, most_disks);
    const std::size_t part = c.dice.below(3);
    std::vector<Disk> disks;
    for (const Point p : points) {
        const Point other = points[c.dice.below(points.size())];
        const double step = std::fabs(c.dice.below(2) ? p.x - other.x : p.y - other.y);
        const double radius = part == 0 ? step : part == 1 ? step / 4 : 0;
        if (std::isfinite(radius)) disks.push_back({p.x, p.y, radius});
        if (!disks.empty() && c.dice.below(8) == 0) disks.push_back(disks.back());
    }
    return disks;
}

DiskArrays graph_of(const std::vector<Disk>& disks, std::uint64_t secret) {
    Impatient interrupt;
    return DiskArrays(liftmesh::apollonius::apollonius(disks, secret, interrupt));
}

// Whether there is no flaw but in the numbers of circles.
bool fits(const DiskArrays& graph, const std::vector<Disk>& disks) {
    Impatient interrupt;
    const auto verdict = liftmesh::verify(graph.of(disks), 1, {}, interrupt);
    for (std::size_t i = 0; i < static_cast<std::size_t>(DiskFlaw::kinds); ++i)
        if (const auto kind = static_cast<DiskFlaw>(i);
            kind != DiskFlaw::other_circles && verdict.flaws.any(kind))
            return false;
    return true;
}

bool agree(const DiskArrays& a, const DiskArrays& b) {
    return a.simplices == b.simplices && a.neighbors == b.neighbors && a.hull == b.hull &&
           a.hidden == b.hidden && a.duplicates == b.duplicates;
}

void check_moved(Case& c, const std::vector<Disk>& disks, const DiskArrays& found) {
    std::vector<Disk> moved = disks;
    const Disk &from = disks[c.dice.below(disks.size())], &to = disks[c.dice.below(disks.size())];
    Disk& changed = moved[c.dice.below(disks.size())];
    changed = {c.dice.below(2) ? changed.x : from.x, c.dice.below(2) ? changed.y : to.y,
               c.dice.below(2) ? changed.r : from.r / 2};
    if (!native::have_exact_signs(moved)) return;
    const DiskArrays other = graph_of(moved, 3);
    demand(fits(other, disks) == agree(other, found), "a graph of other disks is judged wrongly");
}

// Whatever stands in the arrays, the verifier ends; and it finds a change of what they say.
void check_spoilt(Case& c, const std::vector<Disk>& disks, const DiskArrays& found) {
    DiskArrays spoilt = found;
    std::vector<std::int32_t>* const lists[] = {&spoilt.simplices, &spoilt.neighbors, &spoilt.hull,
                                                &spoilt.hidden, &spoilt.duplicates};
    std::vector<std::int32_t>& list = *lists[c.dice.below(5)];
    if (list.empty()) return;
    list[c.dice.below(list.size())] = static_cast<std::int32_t>(c.dice.below(disks.size() + 3)) - 2;
    demand(fits(spoilt, disks) == agree(spoilt, found), "a spoilt graph is judged wrongly");
}

void check_filters(Case& c, const std::vector<Disk>& disks) {
    const auto given = liftmesh::apollonius::scaled(disks);
    const auto any = [&]() -> const Disk& { return given.disks[c.dice.below(disks.size())]; };
    const Signs exact(false);
    for (int i = 0; i < 8; ++i) {
        const Disk &p = any(), &q = any(), &r = any(), &t = any();
        const auto apart = [&](const Disk& a, const Disk& b) {
            demand(exact.contains(a, b) == given.signs.contains(a, b), "contains: a filter errs");
            return !exact.contains(a, b) && !exact.contains(b, a);
        };
        if (apart(p, q) && apart(q, r) && apart(r, p))
            demand(exact.conflicts(p, q, r, t) == given.signs.conflicts(p, q, r, t),
                   "conflicts: a filter errs");
    }
}

std::vector<std::int32_t> around(const liftmesh::Result& result, std::int32_t row) {
    std::vector<std::int32_t> found;
    for (std::size_t i = 0; i < 3 * result.triangle_count; ++i)
        if (result.simplices[i] == row)
            for (std::size_t k = i - i % 3; k < i - i % 3 + 3; ++k)
                if (result.simplices[k] != row) found.push_back(result.simplices[k]);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

liftmesh::Input input_of(const std::vector<Point>& points) {
    return {reinterpret_cast<const std::byte*>(points.data()), points.size(), sizeof(Point),
            sizeof(double), false};
}

}  // namespace

void check_disks(Case& c, const Rows& rows) {
    const std::vector<Disk> disks = disks_of(c, rows);
    if (disks.empty() || !native::have_exact_signs(disks)) return;
    const DiskArrays found = graph_of(disks, c.dice.below(1000)), again = graph_of(disks, 7);
    demand(found == again, "the order of insertion changes the graph of disks");
    Impatient interrupt;
    demand(!liftmesh::verify(found.of(disks), 1, {}, interrupt).flaws.any(),
           "the verifier finds flaws in a graph of disks");
    for (int i = 0; i < 2; ++i) check_moved(c, disks, found);
    for (int i = 0; i < 3; ++i) check_spoilt(c, disks, found);
    check_filters(c, disks);
}

void check_stars(Case& c, const Rows& rows) {
    const std::vector<Point> points = some_points(c, rows, most_disks);
    Impatient interrupt;
    const auto euclidean = liftmesh::delaunay(input_of(points), false, {}, interrupt);
    if (euclidean.status != liftmesh::Status::ok) return;
    std::vector<Metric> metrics;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto a = static_cast<double>(1 + c.dice.below(9));
        const auto b = static_cast<double>(c.dice.below(9)) - 4;
        metrics.push_back({a, b, std::floor(b * b / a) + 1 + static_cast<double>(c.dice.below(4))});
    }
    const native::Neighborhood given(euclidean.result, points.size());
    liftmesh::anisotropic::Lists found;
    demand(liftmesh::anisotropic::stars({points, metrics, given.starts, given.rows, given.hull},
                                        interrupt, found),
           "stars are interrupted");
    for (std::size_t i = 0; i < std::min(most_stars, points.size()); ++i) {
        const std::size_t row = c.dice.below(points.size());
        const Metric& m = metrics[row];
        const auto whole = liftmesh::delaunay(liftmesh::ByMetric{m.a, m.b, m.c}, input_of(points),
                                              false, {}, interrupt);
        std::vector<std::int32_t> star(found.rows.begin() + found.starts[row],
                                       found.rows.begin() + found.starts[row + 1]);
        std::sort(star.begin(), star.end());
        demand(star == around(whole.result, static_cast<std::int32_t>(row)),
               "a star is not that of the triangulation in its metric");
    }
}

}  // namespace fuzzing
