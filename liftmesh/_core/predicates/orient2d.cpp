#include "predicates/orient2d.hpp"

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"

namespace liftmesh {

namespace {

template <int N>
int sign_of_turn(const PlanarLattice<3>& lattice) {
    const Wide<N> cx = lattice.x<N>(2);
    const Wide<N> cy = lattice.y<N>(2);
    const Wide<N> ax = lattice.x<N>(0) - cx;
    const Wide<N> ay = lattice.y<N>(0) - cy;
    const Wide<N> bx = lattice.x<N>(1) - cx;
    const Wide<N> by = lattice.y<N>(1) - cy;
    return (ax * by - ay * bx).sign();
}

int sign_of_wide_turn(const PlanarLattice<3>& lattice) {
    ExactSum<2> det(lattice.width());
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        det.add(lattice.part_of_x(i) * lattice.part_of_y(j));
        det.subtract(lattice.part_of_y(i) * lattice.part_of_x(j));
    }
    return det.sign();
}

bool axis_parallel(Point a, Point b, Point c) {
    return ((a.x == b.x) & (b.x == c.x)) | ((a.y == b.y) & (b.y == c.y));
}

}  // namespace

int orient2d_exact(Point a, Point b, Point c) {
    if (axis_parallel(a, b, c)) return 0;
    const PlanarLattice<3> lattice({a, b, c});
    if (lattice.fits<1>()) return sign_of_turn<1>(lattice);
    if (lattice.fits<2>()) return sign_of_turn<2>(lattice);
    return sign_of_wide_turn(lattice);
}

}  // namespace liftmesh
