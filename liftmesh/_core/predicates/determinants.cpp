#include "predicates/determinants.hpp"

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"
#include "predicates/wide.hpp"

namespace liftmesh {

namespace {

// The nearest double: of the leading 64 bits, of which the last stands for all that follow. In
// units of 2^low to the power of the degree.
template <int N>
Scaled rounded(const Wide<N>& value, int degree, int low) {
    const Wide<N> size = magnitude(value);
    int top = N - 1;
    while (top >= 0 && size.limb[top] == 0) --top;
    if (top < 0) return {};
    const int shift = std::countl_zero(size.limb[top]);
    std::uint64_t lead = size.limb[top] << shift;
    bool rest = false;
    if (top > 0) {
        const std::uint64_t next = size.limb[top - 1];
        if (shift > 0) lead |= next >> (64 - shift);
        rest = next << shift != 0;
    }
    for (int i = top - 2; i >= 0; --i) rest |= size.limb[i] != 0;
    const auto mantissa = static_cast<double>(lead | static_cast<std::uint64_t>(rest));
    return Scaled::of(value.negative() ? -mantissa : mantissa, degree * low + 64 * top - shift);
}

// Differences are below 2^(64N - 2), and so products of two of them, and differences of these,
// below 2^(128N - 3).
template <int N>
struct Offset {
    Wide<N> x, y;
};
template <int N, int K>
Offset<N> offset(const PlanarLattice<K>& lattice, int i) {
    return {lattice.template x<N>(i) - lattice.template x<N>(K - 1),
            lattice.template y<N>(i) - lattice.template y<N>(K - 1)};
}
template <int N>
Wide<2 * N> cross(const Offset<N>& u, const Offset<N>& v) {
    return u.x * v.y - u.y * v.x;
}
template <int N>
Wide<2 * N> square(const Offset<N>& u) {
    return u.x * u.x + u.y * u.y;
}

template <int K>
struct Turns : PlanarLattice<K> {
    explicit Turns(const Point (&points)[K]) : PlanarLattice<K>(points) {}

    // Off by a few units in the last place.
    Magnitude turn(int a, int b, int c) const {
        ExactSum<2> det(this->width());
        const int cycle[] = {a, b, c};
        for (int i = 0; i < 3; ++i) {
            const int from = cycle[i], to = cycle[(i + 1) % 3];
            det.add(this->part_of_x(from) * this->part_of_y(to));
            det.subtract(this->part_of_y(from) * this->part_of_x(to));
        }
        return det.magnitude();
    }
};

// In units of 1.
Magnitude double_area(Point a, Point b, Point c) {
    const Turns<3> turns({a, b, c});
    const Magnitude found = turns.turn(0, 1, 2);
    if (found.mantissa == 0) return found;
    return {found.mantissa, found.exponent + 2 * turns.low()};
}

double quotient(Magnitude part, Magnitude whole) {
    return std::ldexp(part.mantissa / whole.mantissa, part.exponent - whole.exponent);
}

}  // namespace

Scaled turn(Point a, Point b, Point c) {
    const PlanarLattice<3> lattice({a, b, c});
    return at_width_of(lattice, [&]<int N>() {
        return rounded(cross(offset<N>(lattice, 0), offset<N>(lattice, 1)), 2, lattice.low());
    });
}

Scaled in_circle(Point p, Point q, Point r, Point s) {
    const PlanarLattice<4> lattice({p, q, r, s});
    return at_width_of(lattice, [&]<int N>() {
        const auto a = offset<N>(lattice, 0), b = offset<N>(lattice, 1), c = offset<N>(lattice, 2);
        return rounded(square(a) * cross(b, c) + square(b) * cross(c, a) + square(c) * cross(a, b),
                       4, lattice.low());
    });
}

int turn_in_oyz(Point a, Point b, Point c, Point q) {
    const PlanarLattice<4> lattice({a, b, c, q});
    return at_width_of(lattice, [&]<int N>() {
        const Wide<2 * N> z = square(offset<N>(lattice, 0));
        const auto rise = [&](int i) { return square(offset<N>(lattice, i)) - z; };
        const auto y = [&](int i) { return lattice.y<2 * N>(i) - lattice.y<2 * N>(0); };
        return (y(1) * rise(2) - y(2) * rise(1)).sign();
    });
}

Weights exact_weights(Point a, Point b, Point c, Point query) {
    const Turns<4> turns({a, b, c, query});
    const Magnitude whole = turns.turn(0, 1, 2);
    return {quotient(turns.turn(0, 3, 2), whole), quotient(turns.turn(0, 1, 3), whole)};
}

Point exact_slopes(const Point (&corners)[3], const double (&heights)[3]) {
    const auto [a, b, c] = corners;
    const auto [za, zb, zc] = heights;
    const Magnitude area = double_area(a, b, c);
    return {quotient(double_area({za, a.y}, {zb, b.y}, {zc, c.y}), area),
            quotient(double_area({a.x, za}, {b.x, zb}, {c.x, zc}), area)};
}

}  // namespace liftmesh
