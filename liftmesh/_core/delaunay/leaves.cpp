// The five signs of four points are computed side by side, and held together against the bound for
// the whole part. Where one of them is uncertain, each is decided by the exact predicates.
//
// The determinant here is the sum of three products, so it is off by at most (1 + e)^11 - 1 of
// 6 w h (w^2 + h^2), in the terms of seen_from_base.hpp: less than twice `Certainty::of_circle`.

#include "delaunay/leaves.hpp"

#include "base/pair.hpp"
#include "predicates/lifted_side.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

double cross(Pair u, Pair v) {
    const Pair product = u * swapped(v);
    return product[0] - product[1];
}

double square(Pair u) {
    const Pair product = u * u;
    return product[0] + product[1];
}

bool is_last_below(Paraboloid, const Site* s, Guard guard) {
    return incircle_canonical(s[0].point, s[1].point, s[2].point, s[3].point, guard);
}
bool is_last_below(Farthest by, const Site* s, Guard guard) {
    return side_canonical_exact(by, s[0].point, s[1].point, s[2].point, s[3].point, guard) > 0;
}

template <class Lift>
[[gnu::cold, gnu::noinline]] unsigned signs_in_doubt(Lift by, const Site* sites, Guard guard) {
    const unsigned turns = turns_of_four(sites);
    if (turns == no_leaf) return no_leaf;
    return turns | static_cast<unsigned>(is_last_below(by, sites, guard)) << 4;
}

// For lifts of which the height is the square, up to its sign.
template <class Lift>
unsigned signs_by_square(Lift by, const Site* sites, const Certainty& certainty, Guard guard) {
    const Pair p = pair(sites[0].point), q = pair(sites[1].point), r = pair(sites[2].point);
    const Pair s = pair(sites[3].point);
    const Pair a = p - s, b = q - s, c = r - s;
    const double bc = cross(b, c), ac = cross(a, c), ab = cross(a, b), turn = cross(q - p, r - p);
    const double circle = square(a) * bc - square(b) * ac + square(c) * ab;
    const double least_turn =
        std::min(std::min(std::fabs(bc), std::fabs(ac)), std::min(std::fabs(ab), std::fabs(turn)));
    if (!((least_turn > certainty.of_distance) & (std::fabs(circle) > 2 * certainty.of_circle)))
        [[unlikely]]
        return signs_in_doubt(by, sites, guard);
    const bool is_below = std::is_same_v<Lift, Farthest> ? circle < 0 : circle > 0;
    return static_cast<unsigned>(bc > 0) | static_cast<unsigned>(ac > 0) << 1 |
           static_cast<unsigned>(ab > 0) << 2 | static_cast<unsigned>(turn > 0) << 3 |
           static_cast<unsigned>(is_below) << 4;
}

}  // namespace

unsigned middle_of_three(const Site* sites) {
    const bool second_follows = before_xy(sites[0].point, sites[1].point);
    const bool third_follows_second = before_xy(sites[1].point, sites[2].point);
    if (second_follows == third_follows_second) return 1;
    return before_xy(sites[0].point, sites[2].point) == second_follows ? 2 : 0;
}

unsigned turns_of_four(const Site* s) {
    const int turn[4] = {
        orient2d(s[1].point, s[2].point, s[3].point), orient2d(s[0].point, s[2].point, s[3].point),
        orient2d(s[0].point, s[1].point, s[3].point), orient2d(s[0].point, s[1].point, s[2].point)};
    unsigned signs = 0;
    for (unsigned k = 0; k < 4; ++k) {
        if (turn[k] == 0) return no_leaf;
        signs |= static_cast<unsigned>(turn[k] > 0) << k;
    }
    return signs;
}

unsigned signs_of_four(Paraboloid by, const Site* sites, const Certainty& certainty, Guard guard) {
    return signs_by_square(by, sites, certainty, guard);
}
unsigned signs_of_four(Farthest by, const Site* sites, const Certainty& certainty, Guard guard) {
    return signs_by_square(by, sites, certainty, guard);
}

unsigned signs_of_four(const ByMetric& by, const Site* sites, const Certainty& certainty,
                       Guard guard) {
    const Point p[4] = {sites[0].point, sites[1].point, sites[2].point, sites[3].point};
    const unsigned turns = turns_of_four(sites);
    if (turns == no_leaf) return no_leaf;
    const Base base(by, pair(p[0]), pair(p[1]));
    const double value = below(base.place(pair(p[2])), base.place(pair(p[3])));
    const bool is_inside = std::fabs(value) > certainty.of_circle
                               ? value > 0
                               : side_canonical_exact(by, p[0], p[1], p[2], p[3], guard) > 0;
    return turns | static_cast<unsigned>(is_inside) << 4;
}

}  // namespace liftmesh
