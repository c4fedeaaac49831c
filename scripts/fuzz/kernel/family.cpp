// Regular triangulations, Delaunay triangulations in a metric and farthest-point triangulations,
// judged by integers of any length.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "checks.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "verify/verify.hpp"

namespace fuzzing {

namespace {

using liftmesh::Member;
using liftmesh::Regular;
using liftmesh::Row;
using liftmesh::Status;

constexpr std::size_t most_rows = 40, most_wide_rows = 10;
constexpr liftmesh::ByMetric metric{form[0], form[1], form[2]};

// Weights that hide some rows or none, or have nothing to do with the coordinates.
std::vector<double> values_of(Case& c) {
    const std::size_t kind = c.dice.below(4);
    std::vector<double> values(c.rows());
    for (std::size_t row = 0; row < c.rows(); ++row) {
        const Point p = c.point(c.dice.below(c.rows()));
        const auto small = static_cast<double>(c.dice.below(8));
        const double choice[] = {small, std::fabs(p.x), std::fabs(p.x * p.x / 4),
                                 std::ldexp(small, static_cast<int>(c.dice.below(60)) - 30)};
        values[row] = std::isfinite(choice[kind]) ? choice[kind] : small;
    }
    return values;
}

class Judge {
 public:
    Judge(const Case& c, Lift lift, const std::vector<double>& values, const Regular& found)
        : c_(c), lift_(lift), values_(values), r_(found.result) {}

    // Each edge with the apex beyond it: every vertex but the ends would do.
    void check_edges() const {
        for (std::size_t t = 0; t < r_.triangle_count; ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t u = r_.neighbors[3 * t + k];
                if (u < 0) continue;
                for (std::size_t j = 0; j < 3; ++j) {
                    const Row apex = corner(static_cast<std::size_t>(u), j);
                    if (apex != corner(t, 0) && apex != corner(t, 1) && apex != corner(t, 2))
                        demand(side(t, apex, true) < 0, "an edge is not regular, or not canonical");
                }
            }
    }

    void check_hidden(const Regular& found) const {
        for (const Row row : found.hidden) {
            std::size_t t = 0;
            while (t < r_.triangle_count && !contains(t, row)) ++t;
            demand(t < r_.triangle_count, "a hidden row is outside");
            demand(is_at_corner(t, row) ? is_lighter(t, row) : side(t, row, false) < 0,
                   "a hidden row is not above the triangles");
        }
    }

 private:
    Row corner(std::size_t t, std::size_t k) const {
        return static_cast<Row>(r_.simplices[3 * t + k % 3]);
    }
    int side(std::size_t t, Row d, bool canonical) const {
        const Row rows[4] = {corner(t, 0), corner(t, 1), corner(t, 2), d};
        std::array<Point, 4> points;
        std::array<double, 4> values;
        for (std::size_t i = 0; i < 4; ++i) {
            points[i] = c_.point(rows[i]);
            values[i] = values_[rows[i]];
        }
        return lifted_side(lift_, points, values, canonical);
    }
    bool contains(std::size_t t, Row row) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (turn(c_.point(corner(t, k)), c_.point(corner(t, k + 1)), c_.point(row)) < 0)
                return false;
        return true;
    }
    bool is_at_corner(std::size_t t, Row row) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (c_.point(corner(t, k)) == c_.point(row)) return true;
        return false;
    }
    bool is_lighter(std::size_t t, Row row) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (c_.point(corner(t, k)) == c_.point(row))
                return values_[row] < values_[corner(t, k)];
        return false;
    }

    const Case& c_;
    Lift lift_;
    const std::vector<double>& values_;
    const liftmesh::Result& r_;
};

void check_verdict(const Case& c, Lift lift, const std::vector<double>& values,
                   const Regular& found) {
    constexpr Member::Kind kinds[] = {Member::Kind::weights, Member::Kind::radii,
                                      Member::Kind::metric, Member::Kind::farthest};
    const Member member{kinds[static_cast<std::size_t>(lift)], values.data(), metric};
    const auto locate = [&](const liftmesh::Question& q) {
        Impatient interrupt;
        liftmesh::Locator locator({{reinterpret_cast<const std::byte*>(q.points), q.rows,
                                    sizeof(Point), sizeof(double), false},
                                   q.simplices,
                                   q.neighbors,
                                   q.count},
                                  q.queried);
        return locator.find({reinterpret_cast<const double*>(q.queries), q.queried}, q.found, {},
                            interrupt);
    };
    Impatient interrupt;
    const liftmesh::Verdict verdict =
        liftmesh::verify(c.input, found.result.simplices.get(), found.result.triangle_count,
                         c.skip_non_finite, member, locate, c.threads, interrupt);
    demand(verdict.status == Status::ok && !verdict.flaws.any(), "the verifier finds flaws");
}

void check_member(const Case& c, Lift lift, const std::vector<double>& values,
                  const Expectation& expected, const Regular& found) {
    demand(found.status == expected.status, "a member comes to another status");
    if (found.status != Status::ok) return;
    Rows finite = expected.kept;
    for (const liftmesh::Duplicate& pair : expected.merged) finite.push_back(pair.row);
    const Rows corners = check_structure(c, found.result, finite);
    demand(found.skipped == expected.skipped, "a member skips other rows");
    demand(corners.size() + found.hidden.size() + found.duplicates.size() == finite.size(),
           "a row is lost");
    for (const liftmesh::Duplicate& pair : found.duplicates)
        demand(c.point(pair.row) == c.point(pair.kept) &&
                   (lift == Lift::farthest || lift == Lift::metric ||
                    values[pair.row] == values[pair.kept]),
               "a duplicate is of another row");
    const Judge judge(c, lift, values, found);
    judge.check_edges();
    judge.check_hidden(found);
    check_verdict(c, lift, values, found);
}

}  // namespace

void check_family(Case& c, const Expectation& expected) {
    if (c.rows() > (c.is_wide ? most_wide_rows : most_rows)) return;
    const std::vector<double> values = values_of(c);
    for (const Lift lift : {Lift::weights, Lift::radii}) {
        Impatient interrupt;
        const liftmesh::Values given{reinterpret_cast<const std::byte*>(values.data()),
                                     sizeof(double), false, lift == Lift::radii};
        check_member(c, lift, values, expected,
                     liftmesh::regular(c.input, given, c.skip_non_finite, c.threads, interrupt));
    }
    Impatient patient;
    check_member(c, Lift::metric, values, expected,
                 {liftmesh::delaunay(metric, c.input, c.skip_non_finite, c.threads, patient), {}});
    Impatient interrupt;
    check_member(c, Lift::farthest, values, expected,
                 liftmesh::farthest(c.input, c.skip_non_finite, c.threads, interrupt));
}

}  // namespace fuzzing
