#include "cells/power_centre.hpp"
#include "predicates/lifted_determinant.hpp"

namespace liftmesh {

namespace {

constexpr double e = 0x1p-53, square_of_e = e * e;

template <class Lift>
constexpr bool is_plain = std::is_same_v<Lift, Paraboloid>;

template <class Lift>
double excess(const Lift& lift, const Lifted<Lift>& t, const Lifted<Lift>& s) {
    if constexpr (is_plain<Lift>)
        return 0;
    else
        return lift.excess(t.value, s.value);
}

// --- filters ------------------------------------------------------------------------------------

struct Gap {
    double value, error;
};

// The power of p by t less that by s: (s - t) (p - s + p - t) - (w_t - w_s). Each coordinate of the
// product errs by 4 e of |s - t| (|p - s| + |p - t|), the excess by 3 e of itself, the sums by 2 e.
template <class Lift>
Gap gap(const Lift& lift, Point p, const Lifted<Lift>& s, const Lifted<Lift>& t) {
    const Pair at = pair(p), from_s = at - pair(s.point), from_t = at - pair(t.point);
    const Pair between = pair(s.point) - pair(t.point);
    const Pair product = between * (from_s + from_t);
    const Pair size = magnitudes(between) * (magnitudes(from_s) + magnitudes(from_t));
    const double lowered = excess(lift, t, s);
    return {product[0] + product[1] - lowered, 8 * e * (size[0] + size[1] + std::fabs(lowered))};
}

int sign(double value, double error) {
    return (value > error) - (-value > error);
}

// --- exact signs --------------------------------------------------------------------------------

// Sites, and points without a value, on one lattice.
template <class Lift, int Sites, int Points>
LiftedLattice<Lift, Sites + Points> lattice(const Lift& lift,
                                            const std::array<Lifted<Lift>, Sites>& sites,
                                            const std::array<Point, Points>& points) {
    Lifted<Lift> all[Sites + Points];
    for (int i = 0; i < Sites; ++i) all[i] = sites[static_cast<std::size_t>(i)];
    for (int i = 0; i < Points; ++i) all[Sites + i] = {points[static_cast<std::size_t>(i)], {}};
    return {lift, all};
}

Term<2> negated(Term<2> term) {
    term.negative = !term.negative;
    return term;
}
Term<2> twice(Term<2> term) {
    ++term.shift;
    return term;
}

// The summands of a gap: h_t - h_s - 2 p (t - s).
template <class Lattice>
std::vector<Term<2>> gap_terms(const Lattice& on, int p, int s, int t) {
    std::vector<Term<2>> terms;
    for (const auto& part : on.height(t)) terms.push_back(part);
    for (const auto& part : on.height(s)) terms.push_back(negated(part));
    terms.push_back(negated(twice(on.part_of_x(p) * on.part_of_x(t))));
    terms.push_back(negated(twice(on.part_of_y(p) * on.part_of_y(t))));
    terms.push_back(twice(on.part_of_x(p) * on.part_of_x(s)));
    terms.push_back(twice(on.part_of_y(p) * on.part_of_y(s)));
    return terms;
}

template <class Lift>
int exact_gap(const Lift& lift, Point p, const Lifted<Lift>& s, const Lifted<Lift>& t) {
    const auto on = lattice<Lift, 2, 1>(lift, {s, t}, {p});
    ExactSum<2> sum(on.width());
    for (const Term<2>& term : gap_terms(on, 2, 0, 1)) sum.add(term);
    return sum.sign();
}

// The gap of t at the start times that of u at the end, less the gap of u times that of t.
template <class Lift>
int exact_order(const Lift& lift, LineSegment segment, const Lifted<Lift>& s, const Lifted<Lift>& t,
                const Lifted<Lift>& u) {
    const auto on = lattice<Lift, 3, 2>(lift, {s, t, u}, {segment.from, segment.to});
    ExactSum<4> sum(on.width());
    const auto t_from = gap_terms(on, 3, 0, 1), t_to = gap_terms(on, 4, 0, 1);
    const auto u_from = gap_terms(on, 3, 0, 2), u_to = gap_terms(on, 4, 0, 2);
    for (const auto& one : t_from)
        for (const auto& other : u_to) sum.add(one * other);
    for (const auto& one : u_from)
        for (const auto& other : t_to) sum.subtract(one * other);
    return sum.sign();
}

// The sign of (to - from) (u - t).
int exact_along(LineSegment segment, Point t, Point u) {
    const PlanarLattice<4> on({segment.from, segment.to, t, u});
    ExactSum<2> sum(on.width());
    for (const auto [end, site, is_positive] :
         {std::array<int, 3>{1, 3, 1}, {1, 2, 0}, {0, 3, 0}, {0, 2, 1}}) {
        const Term<2> x = on.part_of_x(end) * on.part_of_x(site);
        const Term<2> y = on.part_of_y(end) * on.part_of_y(site);
        sum.add(is_positive ? x : negated(x));
        sum.add(is_positive ? y : negated(y));
    }
    return sum.sign();
}

// Where all three cells meet on the segment. With shares r, s, t of the infinitesimals, the order
// is the sign of share_u (gap of t falls) - share_t (gap of u falls) + share_s (the difference).
bool perturbed_order(LineSegment segment, Point s, Point t, Point u) {
    const bool is_u_last = before_xy(t, u);
    const Point last = is_u_last ? u : t;
    if (before_xy(last, s))
        if (const int sign = exact_along(segment, t, u); sign != 0) return sign > 0;
    return is_u_last;
}

DoubleWord<double> precise_excess(ByWeight, double t, double s) {
    return exact_difference(t, s);
}
DoubleWord<double> precise_excess(ByRadius, double t, double s) {
    return exact_difference(t, s) * exact_sum(t, s);
}

}  // namespace

// Each product errs by 3 e of itself, the sum by e.
int sign_along(LineSegment segment, Point s, Point t, Guard guard) {
    const Pair products = (pair(segment.to) - pair(segment.from)) * (pair(t) - pair(s));
    const Pair sizes = magnitudes(products);
    const int found =
        sign(products[0] + products[1], 5 * e * (sizes[0] + sizes[1]) + guard.margin());
    return found != 0 ? found : exact_along(segment, s, t);
}

template <class Lift>
int gap_sign(const Lift& lift, Point p, const Lifted<Lift>& s, const Lifted<Lift>& t, Guard guard) {
    const Gap found = gap(lift, p, s, t);
    const int side = sign(found.value, found.error + guard.margin());
    return side != 0 ? side : exact_gap(lift, p, s, t);
}

template <class Lift>
bool enters_before(const Lift& lift, LineSegment segment, const Lifted<Lift>& s,
                   const Lifted<Lift>& t, const Lifted<Lift>& u, Guard guard) {
    const Gap t0 = gap(lift, segment.from, s, t), t1 = gap(lift, segment.to, s, t);
    const Gap u0 = gap(lift, segment.from, s, u), u1 = gap(lift, segment.to, s, u);
    const double left = t0.value * u1.value, right = u0.value * t1.value;
    // The factor leaves room for products of two errors, as long as these are below the values.
    const double error = 2 * (t0.error * std::fabs(u1.value) + std::fabs(t0.value) * u1.error +
                              u0.error * std::fabs(t1.value) + std::fabs(u0.value) * t1.error) +
                         2 * (t0.error * u1.error + u0.error * t1.error) +
                         4 * e * (std::fabs(left) + std::fabs(right)) + guard.margin();
    int order = sign(left - right, error);
    if (order == 0) order = exact_order(lift, segment, s, t, u);
    return order != 0 ? order > 0 : perturbed_order(segment, s.point, t.point, u.point);
}

// With r = t - s, m = p - s + p - t and d = q - p, the gap at p is -r m less the excess, and falls
// by 2 r d. Double words: r and d are exact, m errs by 3 u^2, each product by 5 u^2, sums by 3 u^2,
// so the gap by 12 u^2 of G, the sum of magnitudes, its fall by 17 u^2 of Q = |r_x d_x| + |r_y
// d_y|, the quotient by 15 u^2. The constants are larger, for the rounding of the bound.
template <class Lift>
Estimate crossing(const Lift& lift, LineSegment segment, const Lifted<Lift>& s,
                  const Lifted<Lift>& t, Guard guard) {
    const Pair p = pair(segment.from), at_s = pair(s.point), at_t = pair(t.point);
    const auto r = exact_difference(at_t, at_s), d = exact_difference(pair(segment.to), p);
    const DoubleWord<Pair> gaps = r * (exact_difference(p, at_s) + exact_difference(p, at_t));
    DoubleWord<double> start = -(first(gaps) + second(gaps));
    double size = std::fabs(gaps.high[0]) + std::fabs(gaps.high[1]);
    if constexpr (!is_plain<Lift>) {
        const DoubleWord<double> lowered = precise_excess(lift, t.value, s.value);
        start = start - lowered;
        size += std::fabs(lowered.high);
    }
    const DoubleWord<Pair> falls = r * d;
    const DoubleWord<double> half = first(falls) + second(falls), fall{2 * half.high, 2 * half.low};
    const double of_falls = std::fabs(falls.high[0]) + std::fabs(falls.high[1]);
    const DoubleWord<double> share = start / fall;
    const DoubleWord<Pair> at = p + d * both(share);
    const double part = std::fabs(share.high);
    const double doubt = (16 * size + 20 * part * of_falls) / fall.high + 24 * part;
    const Pair error = square_of_e * (magnitudes(d.high) * doubt + 4.0 * magnitudes(at.high));
    const bool is_known = guard.vouches() && fall.high > 0x1p-90 * of_falls;
    return {at, is_known ? error + 0x1p-1000 * magnitudes(d.high) : Pair{unknown, unknown}};
}

#define LIFTMESH_INSTANCES(Lift)                                                                   \
    template int gap_sign(const Lift&, Point, const Lifted<Lift>&, const Lifted<Lift>&, Guard);    \
    template bool enters_before(const Lift&, LineSegment, const Lifted<Lift>&,                     \
                                const Lifted<Lift>&, const Lifted<Lift>&, Guard);                  \
    template Estimate crossing(const Lift&, LineSegment, const Lifted<Lift>&, const Lifted<Lift>&, \
                               Guard);
LIFTMESH_INSTANCES(Paraboloid)
LIFTMESH_INSTANCES(ByWeight)
LIFTMESH_INSTANCES(ByRadius)
#undef LIFTMESH_INSTANCES

}  // namespace liftmesh
