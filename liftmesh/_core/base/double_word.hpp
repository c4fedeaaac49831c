// Numbers as unevaluated sums of two doubles, of which the first is the sum rounded: some 106 bits.
//
// The algorithms are those of Dekker (1971) and Knuth, without fused operations; the bounds on
// their relative errors, with u = 2^-53 and up to terms of u^3, are those of Joldes, Muller and
// Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic"
// (ACM TOMS 44, 2017). They hold where nothing underflows or overflows.
//
// Real is a double, or a pair of doubles that are computed with side by side.
#pragma once

#include "base/pair.hpp"

namespace liftmesh {

template <class Real>
struct DoubleWord {
    Real high, low;
};

template <class Real>
DoubleWord<Real> operator-(const DoubleWord<Real>& a) {
    return {-a.high, -a.low};
}

// a + b exactly, where |a| >= |b| or a = 0.
template <class Real>
DoubleWord<Real> quick_sum(Real a, Real b) {
    const Real sum = a + b;
    return {sum, b - (sum - a)};
}

// a + b exactly.
template <class Real>
DoubleWord<Real> exact_sum(Real a, Real b) {
    const Real sum = a + b, part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

template <class Real>
DoubleWord<Real> exact_difference(Real a, Real b) {
    return exact_sum(a, -b);
}

// The upper 26 bits of a number, and the rest.
template <class Real>
DoubleWord<Real> halves(Real a) {
    const Real scaled = a * 134217729.0, high = scaled - (scaled - a);
    return {high, a - high};
}

// a b exactly.
template <class Real>
DoubleWord<Real> exact_product(Real a, Real b) {
    const Real product = a * b;
    const DoubleWord<Real> p = halves(a), q = halves(b);
    return {product,
            ((p.high * q.high - product) + p.high * q.low + p.low * q.high) + p.low * q.low};
}

// Within 3 u^2 of the sum.
template <class Real>
DoubleWord<Real> operator+(const DoubleWord<Real>& a, const DoubleWord<Real>& b) {
    const DoubleWord<Real> high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
    const DoubleWord<Real> sum = quick_sum(high.high, high.low + low.high);
    return quick_sum(sum.high, low.low + sum.low);
}

template <class Real>
DoubleWord<Real> operator-(const DoubleWord<Real>& a, const DoubleWord<Real>& b) {
    return a + -b;
}

// Within 2 u^2 of the sum.
template <class Real>
DoubleWord<Real> operator+(Real a, const DoubleWord<Real>& b) {
    const DoubleWord<Real> sum = exact_sum(a, b.high);
    return quick_sum(sum.high, b.low + sum.low);
}

// Within 5 u^2 of the product.
template <class Real>
DoubleWord<Real> operator*(const DoubleWord<Real>& a, const DoubleWord<Real>& b) {
    const DoubleWord<Real> product = exact_product(a.high, b.high);
    return quick_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

// Within 15 u^2 of the quotient: two digits of a long division.
template <class Real>
DoubleWord<Real> operator/(const DoubleWord<Real>& a, const DoubleWord<Real>& b) {
    const Real first = a.high / b.high;
    const DoubleWord<Real> product = exact_product(first, b.high);
    const DoubleWord<Real> rest = a - quick_sum(product.high, product.low + first * b.low);
    return quick_sum(first, rest.high / b.high);
}

inline double root(double a) {
    return std::sqrt(a);
}
inline Pair root(Pair a) {
    return Pair{std::sqrt(a[0]), std::sqrt(a[1])};
}

// Within 4 u^2 of the root.
template <class Real>
DoubleWord<Real> root(const DoubleWord<Real>& a) {
    const Real high = root(a.high);
    const DoubleWord<Real> product = exact_product(high, high);
    return quick_sum(high, ((a.high - product.high) - product.low + a.low) / (high + high));
}

template <class Real>
DoubleWord<Real> operator*(const DoubleWord<Real>& a, double power_of_two) {
    return {a.high * power_of_two, a.low * power_of_two};
}

// Whether every number within the error rounds to the higher part. The error is widened by more
// than the rounding of the sums below.
template <class Real>
bool rounds_to_high(const DoubleWord<Real>& a, Real error) {
    const Real reach = error + 0x1p-50 * magnitudes(a.low);
    return are_equal(a.high + (a.low + reach), a.high) &&
           are_equal(a.high + (a.low - reach), a.high);
}

inline DoubleWord<Pair> swapped(const DoubleWord<Pair>& a) {
    return {swapped(a.high), swapped(a.low)};
}
inline DoubleWord<Pair> both(const DoubleWord<double>& a) {
    return {Pair{a.high, a.high}, Pair{a.low, a.low}};
}
inline DoubleWord<double> first(const DoubleWord<Pair>& a) {
    return {a.high[0], a.low[0]};
}
inline DoubleWord<double> second(const DoubleWord<Pair>& a) {
    return {a.high[1], a.low[1]};
}

// Points known to within an error, which may be enough to round their coordinates correctly.

struct Estimate {
    DoubleWord<Pair> centre;
    Pair error;
};

inline bool is_certain(const Estimate& found) {
    return rounds_to_high(found.centre, found.error);
}

}  // namespace liftmesh
