#include "predicates/determinants.hpp"

#include <bit>
#include <cstdint>

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

template <int N>
Scaled turn_of(const PlanarLattice<3>& lattice) {
    return rounded(cross(offset<N>(lattice, 0), offset<N>(lattice, 1)), 2, lattice.low());
}

template <int N>
Scaled in_circle_of(const PlanarLattice<4>& lattice) {
    const auto a = offset<N>(lattice, 0), b = offset<N>(lattice, 1), c = offset<N>(lattice, 2);
    return rounded(square(a) * cross(b, c) + square(b) * cross(c, a) + square(c) * cross(a, b), 4,
                   lattice.low());
}

}  // namespace

Scaled turn(Point a, Point b, Point c) {
    const PlanarLattice<3> lattice({a, b, c});
    if (lattice.fits<1>()) return turn_of<1>(lattice);
    if (lattice.fits<2>()) return turn_of<2>(lattice);
    if (lattice.fits<8>()) return turn_of<8>(lattice);
    return turn_of<33>(lattice);  // 2 098 bits: every finite double
}

Scaled in_circle(Point a, Point b, Point c, Point d) {
    const PlanarLattice<4> lattice({a, b, c, d});
    if (lattice.fits<1>()) return in_circle_of<1>(lattice);
    if (lattice.fits<2>()) return in_circle_of<2>(lattice);
    if (lattice.fits<8>()) return in_circle_of<8>(lattice);
    return in_circle_of<33>(lattice);  // 2 098 bits: every finite double
}

}  // namespace liftmesh
