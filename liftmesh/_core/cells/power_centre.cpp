#include "cells/power_centre.hpp"

#include "base/pair.hpp"
#include "predicates/fixed_point.hpp"
#include "predicates/incircle.hpp"
#include "predicates/lifted_determinant.hpp"
#include "predicates/nearest_double.hpp"

namespace liftmesh {

namespace {

constexpr double u2 = 0x1p-106;

// --- the filter ---------------------------------------------------------------------------------

// By how much b is lowered more than a: within 5 u^2.
DoubleWord<double> excess(ByWeight, double b, double a) {
    return exact_difference(b, a);
}
DoubleWord<double> excess(ByRadius, double b, double a) {
    return exact_difference(b, a) * exact_sum(b, a);
}

struct Height {
    DoubleWord<double> value;
    double magnitude;  // the error is at most 12 u^2 times this
};

// The height of the site at `step` from a, above the plane that touches at a.
template <class Lift>
Height height(const Lift& lift, const DoubleWord<Pair>& step, const Lifted<Lift>& b,
              const Lifted<Lift>& a) {
    const DoubleWord<Pair> squares = step * step;
    const DoubleWord<double> square = first(squares) + second(squares);
    if constexpr (std::is_same_v<Lift, Paraboloid>) {
        return {square, square.high};
    } else {
        const DoubleWord<double> lowering = excess(lift, b.value, a.value);
        return {square - lowering, square.high + std::fabs(lowering.high)};
    }
}

struct QuickHeight {
    double value, magnitude;
};

template <class Lift>
QuickHeight quick_height(const Lift& lift, Pair squares, const Lifted<Lift>& b,
                         const Lifted<Lift>& a) {
    const double square = squares[0] + squares[1];
    if constexpr (std::is_same_v<Lift, Paraboloid>) {
        return {square, square};
    } else {
        const double lowering = lift.excess(b.value, a.value);
        return {square - lowering, square + std::fabs(lowering)};
    }
}

// With u and v, the steps from a to the other sites, and their heights A and B, the centre is
// a + q / 2, where q = (A v' - B u') / det(u, v) and (x, y)' = (y, -x).
constexpr Pair half_of_turned{0.5, -0.5};

// In doubles, where e = 2^-53: steps err by e of what they are, heights by 4 e of it (with weights,
// by 5 e of their magnitudes), so the numerator by 7 e (8 e) of P = |A| |v'| + |B| |u'|, the
// determinant by 4 e of Q = |u_x v_y| + |u_y v_x|, and the quotient by 2 e of itself. The sum with
// a is exact. As q is small where sites are many, this is certain for most of them. The constants
// are a little larger than half of these, for the rounding of the bound itself and terms of e^2.
template <class Lift>
Estimate quick_estimate(const Lift& lift, const Lifted<Lift> (&sites)[3]) {
    const Pair origin = pair(sites[0].point);
    const Pair u = pair(sites[1].point) - origin, v = pair(sites[2].point) - origin;
    const auto [a, size_of_a] = quick_height(lift, u * u, sites[1], sites[0]);
    const auto [b, size_of_b] = quick_height(lift, v * v, sites[2], sites[0]);
    const Pair products = u * swapped(v), sizes = magnitudes(products);
    const double determinant = products[0] - products[1], inverse = 1 / determinant;
    const double q = sizes[0] + sizes[1];
    const Pair quotient = (a * swapped(v) - b * swapped(u)) * inverse;
    const Pair p = size_of_a * magnitudes(swapped(v)) + size_of_b * magnitudes(swapped(u));
    const Pair size = magnitudes(quotient);
    constexpr double share = std::is_same_v<Lift, Paraboloid> ? 3.6 : 4.1;
    const Pair error = 0x1p-53 * ((share * p + 2.1 * q * size) * inverse + 1.1 * size);
    const bool is_far_from_zero = determinant > 0x1p-20 * q;
    return {exact_sum(origin, quotient * half_of_turned),
            is_far_from_zero ? error : Pair{unknown, unknown}};
}

// In double words, where u = 2^-53: steps are exact, heights err by 12 u^2 of their magnitudes, so
// the numerator by 20 u^2 of P, the determinant by 9 u^2 of Q, the quotient and the sum by 15 u^2
// and 2 u^2 of what they are. Here, too, the constants are larger than half of these.
template <class Lift>
Estimate estimate(const Lift& lift, const Lifted<Lift> (&sites)[3]) {
    const Pair origin = pair(sites[0].point);
    const auto u = exact_difference(pair(sites[1].point), origin);
    const auto v = exact_difference(pair(sites[2].point), origin);
    const Height of_u = height(lift, u, sites[1], sites[0]);
    const Height of_v = height(lift, v, sites[2], sites[0]);
    const DoubleWord<Pair> products = u * swapped(v);
    const DoubleWord<double> area = first(products) - second(products);
    const DoubleWord<Pair> numerator =
        both(of_u.value) * swapped(v) - both(of_v.value) * swapped(u);
    const DoubleWord<Pair> quotient = numerator / both(area);
    const DoubleWord<Pair> centre =
        origin + DoubleWord<Pair>{quotient.high * half_of_turned, quotient.low * half_of_turned};
    const Pair sizes = magnitudes(products.high);
    const double q = sizes[0] + sizes[1], determinant = area.high;
    const Pair p =
        of_u.magnitude * magnitudes(swapped(v.high)) + of_v.magnitude * magnitudes(swapped(u.high));
    const Pair size = magnitudes(quotient.high);
    const Pair error = u2 * ((12.0 * p + 6.0 * size * q) / determinant + 10.0 * size +
                             4.0 * magnitudes(centre.high));
    const bool is_far_from_zero = determinant > 0x1p-90 * q;
    return {centre, is_far_from_zero ? error + 0x1p-1000 : Pair{unknown, unknown}};
}

// Whether both numbers are zero or within the bounds.
template <int least, int greatest>
bool are_within(Pair values) {
    const Pair sizes = magnitudes(values);
    const double low = std::ldexp(1.0, least), high = std::ldexp(1.0, greatest);
    const PairBits inside =
        (sizes == Pair{}) | ((sizes >= Pair{low, low}) & (sizes <= Pair{high, high}));
    return (inside[0] & inside[1]) != 0;
}

}  // namespace

// In the window of `Guard` all values above are multiples of 2^-576, or of 2^-952 with weights, and
// below 2^610; and so their parts are exact.
template <class Lift>
bool is_in_window(const Lifted<Lift>& site) {
    constexpr int low = Guard::least_exponent, high = Guard::greatest_exponent;
    bool inside = are_within<low, high>(pair(site.point));
    if constexpr (std::is_same_v<Lift, ByWeight>)
        inside = inside && are_within<2 * low, 2 * high>(Pair{site.value, 0});
    if constexpr (std::is_same_v<Lift, ByRadius>)
        inside = inside && are_within<low, high>(Pair{site.value, 0});
    return inside;
}

namespace {

// --- a start outside the window -----------------------------------------------------------------

double scaled_value(const ByWeight&, double value, int shift) {
    return std::ldexp(value, 2 * shift);
}
double scaled_value(const ByRadius&, double value, int shift) {
    return std::ldexp(value, shift);
}

// Roughly the centre: of the sites scaled to coordinates below 1, by which small ones may be lost.
template <class Lift>
Point rough_centre(const Lift& lift, const Lifted<Lift> (&sites)[3]) {
    double largest = 0;
    for (const auto& site : sites)
        largest = std::max({largest, std::fabs(site.point.x), std::fabs(site.point.y)});
    const int shift = -1 - std::ilogb(largest);
    Lifted<Lift> scaled[3];
    for (int i = 0; i < 3; ++i) {
        scaled[i] = sites[i];
        scaled[i].point = {std::ldexp(sites[i].point.x, shift),
                           std::ldexp(sites[i].point.y, shift)};
        if constexpr (!std::is_same_v<Lift, Paraboloid>)
            scaled[i].value = scaled_value(lift, sites[i].value, shift);
    }
    const Point centre = point(estimate(lift, scaled).centre.high);
    return {std::ldexp(centre.x, -shift), std::ldexp(centre.y, -shift)};
}

// --- exact comparisons --------------------------------------------------------------------------

// The sign of the centre's x minus the midpoint; for mirrored sites, which turn clockwise, that of
// its opposite.
template <class Lift>
int side_of_midpoint(const Lift& lift, const Lifted<Lift> (&sites)[3], NumberOfDouble number) {
    const WithMiddle<LiftedLattice<Lift, 3>> lattice(value_of(number), value_of(number + 1), lift,
                                                     sites);
    ExactSum<3> sum(lattice.width());
    for (int i = 0; i < 3; ++i) {
        const Term<1> next = one_factor(lattice.part_of_y((i + 1) % 3));
        const Term<1> after = one_factor(lattice.part_of_y((i + 2) % 3));
        for (const auto& part : lattice.height(i)) {
            sum.add(part * next);
            sum.subtract(part * after);
        }
        for (const Dyadic& end : lattice.ends()) {
            const Term<2> part = end * lattice.part_of_x(i);
            sum.subtract(part * next);
            sum.add(part * after);
        }
    }
    return sum.sign();
}

template <class Lift>
Lifted<Lift> mirrored(Lifted<Lift> site) {
    site.point = {site.point.y, site.point.x};
    return site;
}

template <class Lift>
Point exact_centre(const Lift& lift, const Lifted<Lift> (&sites)[3], Point near) {
    const Lifted<Lift> other[3] = {mirrored(sites[0]), mirrored(sites[1]), mirrored(sites[2])};
    return {nearest_double(finite_near(near.x),
                           [&](NumberOfDouble n) { return side_of_midpoint(lift, sites, n); }),
            nearest_double(finite_near(near.y),
                           [&](NumberOfDouble n) { return -side_of_midpoint(lift, other, n); })};
}

// --- circles of machine integers ----------------------------------------------------------------

// With D = 2 det(u, v) below 2^126 and N = |u|^2 v_y - |v|^2 u_y below 2^189, the centre's x is
// a_x + N / D. Midpoints are integers on a lattice that is finer by 2^finer.
class IntegerCircle {
 public:
    explicit IntegerCircle(const Lifted<Paraboloid> (&sites)[3])
        : points_({sites[0].point, sites[1].point, sites[2].point}) {}

    // Whether the doubles beside the centre are integers here: it is known to a fraction of their
    // distance, and its coordinates are neither far beyond the sites nor almost zero.
    bool holds(const Estimate& found) const {
        return points_.fits() && holds(found.centre.high[0], found.error[0]) &&
               holds(found.centre.high[1], found.error[1]);
    }

    Point centre(Point near) const {
        const Step u = points_.step(0, 1), v = points_.step(0, 2);
        return {coordinate(near.x, points_.at(0).x, u.y, v.y),
                coordinate(near.y, points_.at(0).y, -u.x, -v.x)};
    }

 private:
    static constexpr int finer = 60;

    int exponent() const { return points_.shift() + finer; }
    bool holds(double value, double error) const {
        const double size = std::fabs(value), units = std::ldexp(size, points_.shift());
        return error < 0x1p-54 * size && units > 0x1p-6 && units < 0x1p61;
    }
    Int128 on_finer_lattice(double value) const { return whole(std::ldexp(value, exponent())); }
    static Wide<2> wide(Int128 value) {
        const auto bits = static_cast<Uint128>(value);
        return {static_cast<std::uint64_t>(bits), static_cast<std::uint64_t>(bits >> 64)};
    }
    static Wide<4> scaled_up(const Wide<4>& value, int bits) {
        Wide<4> result{};
        for (int i = 3; i >= 0; --i) {
            result.limb[i] = value.limb[i] << bits;
            if (i > 0) result.limb[i] |= value.limb[i - 1] >> (64 - bits);
        }
        return result;
    }

    double coordinate(double near, std::int64_t origin, std::int64_t u_across,
                      std::int64_t v_across) const {
        const Step u = points_.step(0, 1), v = points_.step(0, 2);
        const Wide<4> numerator =
            wide(dot(u, u)) * wide(v_across) - wide(dot(v, v)) * wide(u_across);
        const Wide<4> doubled = scaled_up(numerator, finer + 1);
        const Wide<2> denominator = wide(2 * cross(u, v));
        const Int128 start = 2 * (static_cast<Int128>(origin) << finer);
        return nearest_double(near, [&](NumberOfDouble number) {
            const Int128 ends =
                on_finer_lattice(double_of(number)) + on_finer_lattice(double_of(number + 1));
            return (doubled - wide(ends - start) * denominator).sign();
        });
    }

    FixedPoint<3> points_;
};

// The corner between two axis-parallel sides, or 3.
int right_angle(const Lifted<Paraboloid> (&sites)[3]) {
    for (int i = 0; i < 3; ++i) {
        const Point p = sites[i].point, q = sites[(i + 1) % 3].point, r = sites[(i + 2) % 3].point;
        if ((p.x == q.x && p.y == r.y) || (p.y == q.y && p.x == r.x)) return i;
    }
    return 3;
}

double middle(double a, double b) {
    const double sum = a + b;
    return std::isfinite(sum) ? sum * 0.5 : a * 0.5 + b * 0.5;
}

// Out of line, as it is rare.
template <class Lift>
[[gnu::noinline]] Point doubtful_centre(const Lift& lift, const Lifted<Lift> (&sites)[3],
                                        const Estimate& found) {
    const Point near = point(found.centre.high);
    if constexpr (std::is_same_v<Lift, Paraboloid>) {
        if (const int corner = right_angle(sites); corner < 3) {
            const Point p = sites[(corner + 1) % 3].point, q = sites[(corner + 2) % 3].point;
            return {middle(p.x, q.x), middle(p.y, q.y)};
        }
        if (const IntegerCircle circle(sites); circle.holds(found)) return circle.centre(near);
    }
    return exact_centre(lift, sites, near);
}

// The same from an estimate whose bound does not hold.
template <class Lift>
[[gnu::noinline]] Point distant_centre(const Lift& lift, const Lifted<Lift> (&sites)[3]) {
    const Point near = rough_centre(lift, sites);
    return doubtful_centre(lift, sites, Estimate{{pair(near), Pair{}}, Pair{unknown, unknown}});
}

}  // namespace

template <class Lift>
Point power_centre(const Lift& lift, const Lifted<Lift> (&sites)[3], Guard guard) {
    if (!guard.vouches() &&
        !(is_in_window(sites[0]) && is_in_window(sites[1]) && is_in_window(sites[2])))
        return distant_centre(lift, sites);
    if (const Estimate found = quick_estimate(lift, sites); is_certain(found))
        return point(found.centre.high);
    const Estimate found = estimate(lift, sites);
    if (is_certain(found)) return point(found.centre.high);
    return doubtful_centre(lift, sites, found);
}

template bool is_in_window(const Lifted<Paraboloid>&);
template Point power_centre(const Paraboloid&, const Lifted<Paraboloid> (&)[3], Guard);
template bool is_in_window(const Lifted<ByWeight>&);
template Point power_centre(const ByWeight&, const Lifted<ByWeight> (&)[3], Guard);
template bool is_in_window(const Lifted<ByRadius>&);
template Point power_centre(const ByRadius&, const Lifted<ByRadius> (&)[3], Guard);

}  // namespace liftmesh
