#include "predicates/orient2d.hpp"

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"

namespace liftmesh {

namespace {

// From differences of at most 62 bits.
int sign_of_turn(const PlanarLattice<3>& lattice) {
    const Wide<1> cx = lattice.x<1>(2);
    const Wide<1> cy = lattice.y<1>(2);
    const Wide<1> ax = lattice.x<1>(0) - cx;
    const Wide<1> ay = lattice.y<1>(0) - cy;
    const Wide<1> bx = lattice.x<1>(1) - cx;
    const Wide<1> by = lattice.y<1>(1) - cy;
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
    return lattice.fits<1>() ? sign_of_turn(lattice) : sign_of_wide_turn(lattice);
}

}  // namespace liftmesh
