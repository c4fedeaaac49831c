#include "predicates/compare_heights.hpp"

#include "predicates/lattice.hpp"

namespace liftmesh {

namespace {

// Point i of the lattice, lifted with the last one, q, as vertex. Differences are below 2^(64N -
// 2), so heights are below 2^(128N - 3).
template <int N, int K>
Wide<2 * N> height(const PlanarLattice<K>& lattice, int i) {
    const Wide<N> x = lattice.template x<N>(i) - lattice.template x<N>(K - 1);
    const Wide<N> y = lattice.template y<N>(i) - lattice.template y<N>(K - 1);
    return x * x + y * y;
}

template <int N>
int compare(const PlanarLattice<3>& lattice) {
    return (height<N>(lattice, 0) - height<N>(lattice, 1)).sign();
}

template <int N>
int turn(const PlanarLattice<4>& lattice) {
    const auto y = [&](int i) { return lattice.y<2 * N>(i) - lattice.y<2 * N>(0); };
    const auto z = [&](int i) { return height<N>(lattice, i) - height<N>(lattice, 0); };
    return (y(1) * z(2) - y(2) * z(1)).sign();
}

}  // namespace

int compare_heights(Point a, Point b, Point q) {
    const PlanarLattice<3> lattice({a, b, q});
    if (lattice.fits<1>()) return compare<1>(lattice);
    if (lattice.fits<2>()) return compare<2>(lattice);
    if (lattice.fits<8>()) return compare<8>(lattice);
    return compare<33>(lattice);  // 2 098 bits: every finite double
}

int turn_in_oyz(Point a, Point b, Point c, Point q) {
    const PlanarLattice<4> lattice({a, b, c, q});
    if (lattice.fits<1>()) return turn<1>(lattice);
    if (lattice.fits<2>()) return turn<2>(lattice);
    if (lattice.fits<8>()) return turn<8>(lattice);
    return turn<33>(lattice);  // 2 098 bits: every finite double
}

}  // namespace liftmesh
