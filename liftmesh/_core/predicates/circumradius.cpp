#include "predicates/circumradius.hpp"

#include "base/double_word.hpp"
#include "predicates/circumscribed.hpp"
#include "predicates/nearest_double.hpp"

namespace liftmesh {

namespace {

// The squares of s and d, and for a tetrahedron d itself.

template <class Number>
auto top_square(const StepsOf<Number, 2>& at) {
    return square(at.u);
}
template <class Number>
auto top_square(const StepsOf<Number, 3>& at) {
    return square(at.u) * square(at.v) * square(at.side);
}
template <class Number>
auto top_square(const StepsOf<Number, 4>& at) {
    return square(towards_centre(at));
}

// --- the filter of comparisons ------------------------------------------------------------------

// s and d in doubles, with their errors. With e = 2^-53 and L the longest step, differences err by
// e of what they are, squares of steps by 5 e, components of products of two steps by 4 e L^2, as
// the sum of the magnitudes of both terms is at most L^2. So u x v errs by 7 e L^2, components of
// the sum of a tetrahedron by 37 e L^4 and the whole by 65 e L^4, its volume by 14 e L^3. The
// constants are a little larger, for terms of e^2 and the rounding of the bounds.
struct RadiusFilter {
    double s, error_of_s, d, error_of_d;
};

constexpr double vanishing = 0x1p-500;

RadiusFilter radius_filter(const StepsOf<double, 2>& at, double) {
    const double s = std::sqrt(top_square(at));
    return {s, 5 * unit_roundoff * s + vanishing, 1, 0};
}
RadiusFilter radius_filter(const StepsOf<double, 3>& at, double square_of_length) {
    const double s = std::sqrt(top_square(at)), d = std::sqrt(square(cross(at.u, at.v)));
    return {s, 12 * unit_roundoff * s + vanishing, d,
            5 * unit_roundoff * d + 8 * unit_roundoff * square_of_length};
}
RadiusFilter radius_filter(const StepsOf<double, 4>& at, double square_of_length) {
    const double s = std::sqrt(top_square(at)), d = std::fabs(volume(at));
    return {s, 6 * unit_roundoff * s + 66 * unit_roundoff * square_of_length * square_of_length, d,
            15 * unit_roundoff * square_of_length * std::sqrt(square_of_length)};
}

// 1 where the radius is larger than the limit, -1 where it is not, 0 where that is uncertain.
int compare(const RadiusFilter& found, double limit) {
    constexpr double less = 1 - 0x1p-50, more = 1 + 0x1p-50;
    if (found.s + found.error_of_s < 2 * limit * ((found.d - found.error_of_d) * less)) return -1;
    if (found.s - found.error_of_s > 2 * limit * ((found.d + found.error_of_d) * more)) return 1;
    return 0;
}

// --- exact comparisons --------------------------------------------------------------------------

// Of s^2 - d^2 m^2, with the sum m of the two doubles. Steps, and each double, are below
// 2^(64N - 2); components of products of two below 2^(128N - 3); squares and m^2 below
// 2^(128N - 2); components of the sum of a tetrahedron below 2^(256N - 3), its volume below
// 2^(192N - 3); and so both terms below 2^(128(K - 1)N - 1), or 2^(512N - 1) for a tetrahedron.
template <int N>
int sign_of(const StepsOf<Wide<N>, 2>& at, const Wide<2 * N>& square_of_m) {
    return (top_square(at) - square_of_m).sign();
}
template <int N>
int sign_of(const StepsOf<Wide<N>, 3>& at, const Wide<2 * N>& square_of_m) {
    return (top_square(at) - square(cross(at.u, at.v)) * square_of_m).sign();
}
template <int N>
int sign_of(const StepsOf<Wide<N>, 4>& at, const Wide<2 * N>& square_of_m) {
    const Wide<3 * N> d = volume(at);
    return (top_square(at) - d * d * square_of_m).sign();
}

// The sign of the radius minus the middle of two doubles.
template <int K>
int radius_sign(const Corners<K>& corners, Dyadic lower, Dyadic upper) {
    const WithMiddle<SpaceLattice<K>> lattice(lower, upper, corners);
    return at_width_of(lattice, [&]<int N>() {
        const Wide<N> m = lattice.template sum_of_ends<N>();
        const auto step = [&](int to, int from) { return lattice.template step<N>(to, from); };
        return sign_of<N>(steps_of<Wide<N>, K>(step), m * m);
    });
}

// --- radii in double words ----------------------------------------------------------------------

template <class Real>
struct RoundedRadius {
    DoubleWord<Real> value;
    Real error;
};

// Errors relative to the radius, with L^3 / d or L^2 / d for how flat the simplex is: squares of
// steps, which are exact, err by 11 u^2, components of products of two steps by 8 u^2 L^2, of the
// sum of a tetrahedron by 87 u^2 L^4, which is 151 u^2 L^4 in all and at most 151 u^2 L^3 / d of
// the sum, because 2 r >= L. Its volume errs by 25 u^2 L^3, the product of two steps by 14 u^2 L^2,
// roots by half of what is under them and 4 u^2, quotients by 15 u^2.
template <class Real>
RoundedRadius<Real> rounded_radius(const StepsOf<DoubleWord<Real>, 2>& at) {
    const DoubleWord<Real> s = root(top_square(at));
    return {s * 0.5, 0x1p-106 * 12.0 * s.high};
}
template <class Real>
RoundedRadius<Real> rounded_radius(const StepsOf<DoubleWord<Real>, 3>& at) {
    const DoubleWord<Real> d = root(square(cross(at.u, at.v)));
    const DoubleWord<Real> radius = root(top_square(at)) / d * 0.5;
    const Real flatness = (square(at.u).high + square(at.v).high) / d.high;
    return {radius, 0x1p-106 * (15.0 * flatness + 64.0) * radius.high};
}
template <class Real>
RoundedRadius<Real> rounded_radius(const StepsOf<DoubleWord<Real>, 4>& at) {
    const DoubleWord<Real> d = volume(at), radius = root(top_square(at)) / d * 0.5;
    const Real length = square(at.u).high + square(at.v).high + square(at.w).high;
    const Real flatness = length * root(length) / magnitudes(d.high);
    return {radius, 0x1p-106 * (180.0 * flatness + 64.0) * magnitudes(radius.high)};
}

constexpr double uncertain = -1;

// The double that everything within the error rounds to. Beyond an error of 2^-60 the bounds are
// none, as they leave out higher terms.
double rounded(DoubleWord<double> value, double error, RadiusRounding rounding) {
    if (value.high < 0) value = -value;
    const auto [high, low] = value;
    if (!(error < 0x1p-60 * high)) return uncertain;
    if (rounding == RadiusRounding::nearest) return rounds_to_high(value, error) ? high : uncertain;
    const double reach = error + 0x1p-50 * std::fabs(low);
    if (low + reach < 0) return high;
    return low - reach > 0 ? double_of(number_of(high) + 1) : uncertain;
}

// --- outside the window, and in doubt -----------------------------------------------------------

// Of corners whose steps are finite: scaled so that the largest step is near 1.
template <int K>
RoundedRadius<double> scaled_radius(const Corners<K>& p, int shift) {
    const auto scaled = [shift](double to, double from) {
        const auto [high, low] = exact_difference(to, from);
        return DoubleWord<double>{std::ldexp(high, shift), std::ldexp(low, shift)};
    };
    return rounded_radius(steps_of<DoubleWord<double>, K>([&](unsigned to, unsigned from) {
        return Vector<DoubleWord<double>>{scaled(p[to].x, p[from].x), scaled(p[to].y, p[from].y),
                                          scaled(p[to].z, p[from].z)};
    }));
}

// A power of two by which corners are small enough for their steps to be finite.
template <int K>
Corners<K> reduced(Corners<K> corners, double factor) {
    for (SpacePoint& p : corners) p = {p.x * factor, p.y * factor, p.z * factor};
    return corners;
}

template <int K>
[[gnu::noinline]] double doubtful_radius(const Corners<K>& corners, RadiusRounding rounding) {
    constexpr double reduction = 0x1p-30;
    const bool overflows = !has_finite_steps<K>(corners);
    const Corners<K> p = overflows ? reduced<K>(corners, reduction) : corners;
    if (overflows && !has_finite_steps<K>(p)) return std::numeric_limits<double>::infinity();
    const int shift = -exponent_of_greatest(plain_steps<K>(p));
    const RoundedRadius<double> found = scaled_radius<K>(p, shift);
    const double result = rounded(found.value, found.error, rounding);
    const double unscaled = std::ldexp(std::fabs(result), -shift);
    if (result != uncertain && !overflows && unscaled > 0x1p-1021 && unscaled < 0x1p1023)
        return unscaled;
    const double near = finite_near(std::ldexp(std::fabs(found.value.high), -shift) /
                                    (overflows ? reduction : 1.0));
    if (rounding == RadiusRounding::nearest)
        return nearest_double(near, [&](NumberOfDouble number) {
            return radius_sign<K>(corners, value_of(number), value_of(number + 1));
        });
    return first_not_beyond(near, [&](NumberOfDouble number) {
        const Dyadic value = value_of(number);
        return number < 0 || radius_sign<K>(corners, value, value) > 0;
    });
}

// Where underflow or overflow would spoil the filter, steps are scaled by a power of two.
template <int K>
int compare_scaled(const Corners<K>& corners, double limit) {
    StepsOf<double, K> at = plain_steps<K>(corners);
    if (!has_finite_steps<K>(corners)) return 0;
    const int shift = -exponent_of_greatest(at);
    for (Vector<double>* step : {&at.u, &at.v, &at.w, &at.side})
        *step = {std::ldexp(step->x, shift), std::ldexp(step->y, shift),
                 std::ldexp(step->z, shift)};
    return compare(radius_filter(at, square_of_greatest_step(at)), std::ldexp(limit, shift));
}

template <int K>
[[gnu::noinline]] bool is_at_most_exact(const Corners<K>& corners, double limit) {
    if (std::isinf(limit)) return true;
    const Dyadic value = dyadic(limit);
    return radius_sign<K>(corners, value, value) <= 0;
}

}  // namespace

template <int K>
bool is_radius_at_most(const Corners<K>& corners, double limit) {
    const StepsOf<double, K> at = plain_steps<K>(corners);
    const double length = square_of_greatest_step(at);
    const bool is_in_window = length > least_square && length < greatest_square;
    const int sign = is_in_window ? compare(radius_filter(at, length), limit)
                                  : compare_scaled<K>(corners, limit);
    return sign != 0 ? sign < 0 : is_at_most_exact<K>(corners, limit);
}

template <int K>
double circumradius(const Corners<K>& corners, RadiusRounding rounding) {
    return circumradii<K>({corners, corners}, rounding)[0];
}

template <int K>
std::array<double, 2> circumradii(const std::array<Corners<K>, 2>& corners,
                                  RadiusRounding rounding) {
    const Corners<K>&p = corners[0], &q = corners[1];
    const auto at = steps_of<DoubleWord<Pair>, K>([&](unsigned to, unsigned from) {
        return Vector<DoubleWord<Pair>>{
            exact_difference(Pair{p[to].x, q[to].x}, Pair{p[from].x, q[from].x}),
            exact_difference(Pair{p[to].y, q[to].y}, Pair{p[from].y, q[from].y}),
            exact_difference(Pair{p[to].z, q[to].z}, Pair{p[from].z, q[from].z})};
    });
    const auto [value, error] = rounded_radius(at);
    std::array<double, 2> radii;
    for (unsigned i = 0; i < 2; ++i) {
        const double length = square_of_greatest_step(plain_steps<K>(corners[i]));
        const bool is_in_window = length > least_square && length < greatest_square;
        radii[i] =
            is_in_window ? rounded({value.high[i], value.low[i]}, error[i], rounding) : uncertain;
        if (radii[i] == uncertain) radii[i] = doubtful_radius<K>(corners[i], rounding);
    }
    return radii;
}

template bool is_radius_at_most<2>(const Corners<2>&, double);
template bool is_radius_at_most<3>(const Corners<3>&, double);
template bool is_radius_at_most<4>(const Corners<4>&, double);
template double circumradius<2>(const Corners<2>&, RadiusRounding);
template double circumradius<3>(const Corners<3>&, RadiusRounding);
template double circumradius<4>(const Corners<4>&, RadiusRounding);
template std::array<double, 2> circumradii<2>(const std::array<Corners<2>, 2>&, RadiusRounding);
template std::array<double, 2> circumradii<3>(const std::array<Corners<3>, 2>&, RadiusRounding);
template std::array<double, 2> circumradii<4>(const std::array<Corners<4>, 2>&, RadiusRounding);

}  // namespace liftmesh
