// Compares the predicates with their definitions, and the signs that filters certify.

#include <algorithm>
#include <array>
#include <cmath>

#include "checks.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "predicates/determinants.hpp"
#include "predicates/distances.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/orient3d.hpp"
#include "predicates/seen_from_base.hpp"

namespace fuzzing {

namespace {

using liftmesh::Guard;
using liftmesh::Row;

constexpr int rounds = 24;

bool in_window(double value) {
    const double size = std::fabs(value);
    return size == 0 || (std::ilogb(size) >= Guard::least_exponent &&
                         std::ilogb(size) < Guard::greatest_exponent);
}

Guard guard_of(std::initializer_list<double> values) {
    return std::all_of(values.begin(), values.end(), in_window) ? Guard::in_window()
                                                                : Guard::anywhere();
}

Guard guard_of(const std::array<Point, 4>& p) {
    return guard_of({p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y, p[3].x, p[3].y});
}

void check_turn(const std::array<Point, 4>& p) {
    const int sign = fuzzing::turn(p[0], p[1], p[2]);
    demand(liftmesh::orient2d(p[0], p[1], p[2]) == sign, "orient2d has another sign");
    demand(liftmesh::orient2d(p[1], p[2], p[0]) == sign, "orient2d is not cyclic");
    demand(liftmesh::orient2d(p[1], p[0], p[2]) == -sign, "orient2d is not antisymmetric");
}

bool has_canonical_sign(const std::array<Point, 4>& p) {
    return p[3] != p[0] && p[3] != p[1] && p[3] != p[2] && fuzzing::turn(p[0], p[1], p[2]) != 0;
}

void check_incircle(const std::array<Point, 4>& p) {
    const int sign = incircle(p[0], p[1], p[2], p[3], false);
    for (const Guard guard : {guard_of(p), Guard::anywhere()}) {
        using liftmesh::incircle_exact;
        demand(incircle_exact(p[0], p[1], p[2], p[3], guard) == sign, "incircle has another sign");
        demand(incircle_exact(p[1], p[2], p[0], p[3], guard) == sign, "incircle is not cyclic");
        demand(incircle_exact(p[1], p[0], p[2], p[3], guard) == -sign,
               "incircle is not antisymmetric");
        if (!has_canonical_sign(p)) continue;
        const int canonical = incircle(p[0], p[1], p[2], p[3], true);
        demand(canonical != 0, "the perturbation leaves a zero");
        demand(liftmesh::incircle_canonical_exact(p[0], p[1], p[2], p[3], guard) == canonical,
               "the canonical sign differs");
        demand(liftmesh::incircle_canonical(p[0], p[1], p[2], p[3], guard) == (canonical > 0),
               "the in-circle filter certifies a wrong sign");
    }
}

void check_space(const std::array<Point, 4>& p, const std::array<double, 4>& z) {
    std::array<SpacePoint, 4> s;
    for (std::size_t i = 0; i < 4; ++i) s[i] = {p[i].x, p[i].y, z[i]};
    const int sign = orient3d(s[0], s[1], s[2], s[3], false);
    demand(liftmesh::orient3d_exact(s[0], s[1], s[2], s[3]) == sign, "orient3d has another sign");
    demand(liftmesh::orient3d_exact(s[1], s[0], s[2], s[3]) == -sign,
           "orient3d is not antisymmetric");
    if (!has_canonical_sign(p)) return;
    const int canonical = orient3d(s[0], s[1], s[2], s[3], true);
    demand(liftmesh::orient3d_canonical_exact(s[0], s[1], s[2], s[3]) == canonical,
           "the canonical sign in space differs");
    const Guard guard =
        guard_of({z[0], z[1], z[2], z[3]}).vouches() ? guard_of(p) : Guard::anywhere();
    demand(liftmesh::orient3d_canonical(s[0], s[1], s[2], s[3], guard) == (canonical > 0),
           "the filter of orient3d certifies a wrong sign");
}

// A sign that an edge's bound certifies is that of the definition.
void check_margin(double value, double error, int sign, const char* what) {
    if (value > error) demand(sign > 0, what);
    if (-value > error) demand(sign < 0, what);
}

void check_edge(const std::array<Point, 4>& p) {
    if (!guard_of(p).vouches()) return;
    const liftmesh::Pair a = liftmesh::pair(p[0]), b = liftmesh::pair(p[1]),
                         c = liftmesh::pair(p[2]), d = liftmesh::pair(p[3]);
    const liftmesh::Base base(liftmesh::Paraboloid{}, a, b);
    using liftmesh::greatest, liftmesh::least;
    const auto certainty = liftmesh::Certainty::within(
        least(least(a, b), least(c, d)), greatest(greatest(a, b), greatest(c, d)), guard_of(p));
    const double value = liftmesh::below(base.place(c), base.place(d));
    const int side = incircle(p[0], p[1], p[2], p[3], false);
    check_margin(base.place(c)[0], certainty.of_distance, fuzzing::turn(p[0], p[1], p[2]),
                 "the bound of a box certifies a wrong orientation");
    check_margin(value, certainty.of_circle, side,
                 "the bound of a box certifies a wrong in-circle sign");
    check_margin(value,
                 liftmesh::error_of_below<liftmesh::Paraboloid>(base.bound(c), base.bound(d)), side,
                 "an edge certifies a wrong in-circle sign");
}

void check_heights(const std::array<Point, 4>& p) {
    demand(liftmesh::turn_in_oyz(p[0], p[1], p[2], p[3]) ==
               fuzzing::turn_in_oyz(p[0], p[1], p[2], p[3]),
           "turn_in_oyz has another sign");
}

void check_distances(const std::array<Point, 4>& p) {
    for (const Point d : {p[3], p[2], p[1]})
        demand(liftmesh::compare_distances(p[0], p[1], p[2], d) ==
                   fuzzing::compare_distances(p[0], p[1], p[2], d),
               "compare_distances has another sign");
    demand(liftmesh::sign_at_apex(p[0], p[1], p[2]) == fuzzing::sign_at_apex(p[0], p[1], p[2]),
           "sign_at_apex has another sign");
    demand(liftmesh::do_circles_cross(p[0], p[1], p[2], p[3]) ==
               fuzzing::do_circles_cross(p[0], p[1], p[2], p[3]),
           "do_circles_cross decides otherwise");
}

}  // namespace

void check_predicates(Case& c, const Rows& rows) {
    if (rows.empty()) return;
    const auto some = [&] { return rows[c.dice.below(rows.size())]; };
    for (int round = 0; round < rounds; ++round) {
        std::array<Point, 4> p;
        for (Point& each : p) {
            const Row one = some(), other = some();
            each = {c.point(one).x + 0.0, c.point(round % 3 == 0 ? other : one).y + 0.0};
        }
        check_turn(p);
        check_incircle(p);
        check_edge(p);
        check_heights(p);
        check_distances(p);
        check_space(p, {p[1].x, p[2].y, p[3].x, p[0].y});
    }
}

}  // namespace fuzzing
