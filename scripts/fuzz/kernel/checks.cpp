#include "checks.hpp"

#include <atomic>
#include <cmath>

#include "delaunay/first_containing.hpp"
#include "delaunay/locate.hpp"
#include "delaunay/trapezoid_map.hpp"
#include "delaunay/walk.hpp"
#include "demand.hpp"
#include "hull/lower_hull.hpp"
#include "paper/facet_search.hpp"
#include "predicates/orient2d.hpp"

namespace fuzzing {

namespace {

using liftmesh::Delaunay;
using liftmesh::Row;
using liftmesh::Status;

liftmesh::Procedure procedure(Check check) {
    if (check == Check::lf) return liftmesh::Procedure::lf;
    return check == Check::lfres ? liftmesh::Procedure::lfres : liftmesh::Procedure::lfres_indexed;
}

// Gift wrapping is cubic.
std::size_t most_wrapped(const Case& c) {
    return c.is_wide ? 10 : 36;
}

// The least triangle whose closure holds the point, by looking at all.
std::int32_t least_around(const Case& c, const liftmesh::Result& result, Point p) {
    for (std::size_t t = 0; t < result.triangle_count; ++t) {
        const auto corner = [&](std::size_t k) {
            return c.point(static_cast<std::size_t>(result.simplices[3 * t + k % 3]));
        };
        const auto has_inside = [&](std::size_t k) {
            return liftmesh::orient2d(corner(k), corner(k + 1), p) >= 0;
        };
        if (has_inside(0) && has_inside(1) && has_inside(2)) return static_cast<std::int32_t>(t);
    }
    return -1;
}

// A vertex, a point between two, or one at which two others meet.
Point query(Case& c, const Rows& rows) {
    const auto some = [&] { return c.point(rows[c.dice.below(rows.size())]); };
    const Point p = some(), q = some();
    switch (c.dice.below(3)) {
        case 0:
            return p;
        case 1:
            return {p.x / 2 + q.x / 2, p.y / 2 + q.y / 2};
        default:
            return {p.x, q.y};
    }
}

// Of the rows at one position, the lowest in space; of these, the first.
Rows lowest(const Case& c, const Expectation& expected) {
    Rows stand_in(c.rows());
    for (const Row row : expected.kept) stand_in[row] = row;
    for (const liftmesh::Duplicate& pair : expected.merged)
        if (c.points[pair.row].z < c.points[stand_in[pair.kept]].z) stand_in[pair.kept] = pair.row;
    Rows rows;
    for (const Row row : expected.kept) rows.push_back(stand_in[row]);
    return rows;
}

Delaunay hull_by(const Case& c, liftmesh::HullMethod method, std::uint64_t secret = 0) {
    Impatient interrupt;
    liftmesh::paper::Counts counts;
    return liftmesh::lower_hull(c.input, method, secret, c.threads, interrupt, counts);
}

void check_secret(Case& c, const Delaunay& found) {
    const Delaunay salted = hull_by(c, liftmesh::HullMethod::incremental, c.dice.below(1u << 31));
    demand(same_bits(salted.result, found.result), "the facets depend on the secret");
}

// The second index, which location takes for large triangulations only, on as many edges as there
// are, and on a few.
void check_trapezoids(Case& c, const liftmesh::Triangulated& mesh, const std::vector<Point>& points,
                      const std::vector<std::int32_t>& expected) {
    Impatient interrupt;
    liftmesh::Patience patience(interrupt);
    std::vector<liftmesh::Site> sites;
    for (const Point p : points) sites.push_back({p, static_cast<liftmesh::Row>(sites.size())});
    for (const std::size_t edges : {mesh.count / 4 + 1, 4 * mesh.count}) {
        std::vector<std::int32_t> found(sites.size(), liftmesh::outside);
        std::atomic<std::size_t> longest = mesh.count;
        liftmesh::VerticalWalks walks(mesh, longest, [&](const auto& site, const auto& walk) {
            std::size_t steps = 3 * mesh.count;
            if (!walk.is_outside())
                found[site.row] = first_containing(mesh, site.point, walk.at(), steps);
        });
        const liftmesh::TrapezoidMap map(mesh, edges, c.dice.below(1u << 31), patience);
        map.descend(sites.data(), sites.data() + sites.size(), [&](const auto& bundle) {
            if (bundle.edge != liftmesh::no_edge) walks.add(bundle);
        });
        walks.finish();
        demand(found == expected, "a point is found in another triangle by trapezoids");
    }
}

}  // namespace

void check_engine(Case& c, const Delaunay& found) {
    if (found.distinct > most_wrapped(c)) return;
    const Point q = {c.point(0).x, c.point(c.rows() - 1).y};
    const bool has_q = std::isfinite(q.x) && std::isfinite(q.y);
    Impatient interrupt;
    liftmesh::paper::Counts counts;
    const Delaunay wrapped =
        liftmesh::wrap_delaunay(c.input, c.skip_non_finite, procedure(c.check),
                                has_q ? q : Point{0, 0}, c.threads, interrupt, counts);
    demand(wrapped.status == found.status, "gift wrapping comes to another status");
    if (found.status == Status::ok)
        demand(triangles(wrapped.result) == triangles(found.result),
               "gift wrapping finds other triangles");
}

void check_location(Case& c, const Delaunay& found, const Rows& rows) {
    if (c.is_large()) return;
    const liftmesh::Triangulated mesh{c.input, found.result.simplices.get(),
                                      found.result.neighbors.get(), found.result.triangle_count};
    liftmesh::Locator locator(mesh, c.dice.below(1u << 31));
    std::vector<double> queries;
    std::vector<Point> points;
    for (int i = 0; i < 32; ++i) {
        points.push_back(query(c, rows));
        queries.insert(queries.end(), {points.back().x, points.back().y});
    }
    std::vector<std::int32_t> at(points.size());
    Impatient interrupt;
    demand(locator.find({queries.data(), points.size()}, at.data(), c.threads, interrupt),
           "a location ends early");
    for (std::size_t i = 0; i < points.size(); ++i)
        demand(at[i] == least_around(c, found.result, points[i]),
               "a point is found in another triangle");
    check_trapezoids(c, mesh, points, at);
}

void check_lower_hull(Case& c, const Expectation& expected) {
    const Delaunay found = hull_by(c, liftmesh::HullMethod::incremental);
    check_rows(expected, found);
    if (found.status != Status::ok) return;
    check_secret(c, found);
    const Rows rows = lowest(c, expected);
    check_structure(c, found.result, rows);
    if (rows.size() > most_wrapped(c)) return;
    if (2 * rows.size() <= most_wrapped(c)) check_lower(c, found.result, rows);
    const Delaunay wrapped = hull_by(c, liftmesh::HullMethod::lf);
    demand(wrapped.status == found.status, "gift wrapping in space comes to another status");
    demand(triangles(wrapped.result) == triangles(found.result),
           "gift wrapping in space finds other facets");
}

void check_interruption(Case& c, const Delaunay& found) {
    Impatient interrupt(1 + c.dice.below(30));
    const Delaunay cut = liftmesh::delaunay(c.input, c.skip_non_finite, c.threads, interrupt);
    if (cut.status == Status::interrupted) {
        demand(interrupt.was_requested(), "a run was interrupted by nobody");
        return;
    }
    demand(cut.status == found.status, "a run that could be interrupted comes to another status");
    if (cut.status == Status::ok)
        demand(same_bits(cut.result, found.result), "a run that could be interrupted differs");
}

}  // namespace fuzzing
