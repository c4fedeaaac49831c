#include "predicates/orient3d.hpp"

#include "predicates/incircle.hpp"
#include "predicates/lattice.hpp"
#include "predicates/lifted_determinant.hpp"

namespace liftmesh {

namespace {

template <int N>
int sign_of_side(const PlanarLattice<4>& planar, const Lattice<4>& heights) {
    std::array<Wide<N>, 3> dx, dy;
    std::array<Wide<2 * N>, 3> dz;
    for (int i = 0; i < 3; ++i) {
        dx[i] = planar.x<N>(i) - planar.x<N>(3);
        dy[i] = planar.y<N>(i) - planar.y<N>(3);
        dz[i] = heights.at<2 * N>(i) - heights.at<2 * N>(3);
    }
    return sign_of_volume(dx, dy, dz);
}

}  // namespace

// Heights have a lattice of their own, twice as wide, so the units of z seldom determine the width
// of the arithmetic.
int orient3d_exact(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d) {
    if ((a.z == d.z) & (b.z == d.z) & (c.z == d.z)) return 0;
    const PlanarLattice<4> planar({a.planar(), b.planar(), c.planar(), d.planar()});
    const Lattice<4> heights({a.z, b.z, c.z, d.z});
    if (planar.fits<1>() && heights.fits<2>()) return sign_of_side<1>(planar, heights);
    if (planar.fits<2>() && heights.fits<4>()) return sign_of_side<2>(planar, heights);
    if (planar.fits<8>() && heights.fits<16>()) return sign_of_side<8>(planar, heights);
    return sign_of_side<33>(planar, heights);  // 2 098 bits: every finite double
}

int orient3d_canonical_exact(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d) {
    const int sign = orient3d_exact(a, b, c, d);
    return sign != 0 ? sign : perturbed_sign(a.planar(), b.planar(), c.planar(), d.planar());
}

}  // namespace liftmesh
