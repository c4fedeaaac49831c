// The side test of a point against a plane in space.
//
// orient3d(a, b, c, d) for a, b, c counter-clockwise seen from above: +1 where d lies
// below their plane, -1 above, 0 on it. The lift of incircle's d is below the plane exactly where d
// is inside the circle.
//
// The filter is Shewchuk's: |error| <= (7 + 56e) e permanent. It holds where no intermediate
// underflows or overflows, which `Guard` vouches for: planar coordinates and heights, each scaled
// by a power of two of its own, are zero or within [2^-140, 2^200].
#pragma once

#include "base/point.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh {

struct SpacePoint {
    double x, y, z;
    Point planar() const { return {x, y}; }
    bool operator==(const SpacePoint&) const = default;
};

inline bool before_xyz(const SpacePoint& a, const SpacePoint& b) {
    return (a.x < b.x) | ((a.x == b.x) & ((a.y < b.y) | ((a.y == b.y) & (a.z < b.z))));
}

// Both are exact for all finite doubles; called where the filter below is inconclusive.
int orient3d_exact(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d);
int orient3d_canonical_exact(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d);

// The canonical test: as orient3d, but a point on the plane is decided by the symbolic perturbation
// that lifts lexicographically larger points (by x, then y) more. Never 0 for points of distinct
// planar positions.
inline bool orient3d_canonical(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d,
                               Guard guard) {
    constexpr double e = 0x1p-53;
    constexpr double bound = (7 + 56 * e) * e;
    const double adx = a.x - d.x, ady = a.y - d.y, adz = a.z - d.z;
    const double bdx = b.x - d.x, bdy = b.y - d.y, bdz = b.z - d.z;
    const double cdx = c.x - d.x, cdy = c.y - d.y, cdz = c.z - d.z;
    const double bc = bdx * cdy, cb = cdx * bdy;
    const double ca = cdx * ady, ac = adx * cdy;
    const double ab = adx * bdy, ba = bdx * ady;
    const double det = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba);
    const double permanent = std::fabs(adz) * (std::fabs(bc) + std::fabs(cb)) +
                             std::fabs(bdz) * (std::fabs(ca) + std::fabs(ac)) +
                             std::fabs(cdz) * (std::fabs(ab) + std::fabs(ba));
    const double error = bound * permanent + guard.margin();
    if (det > error) return true;
    if (-det > error) return false;
    return orient3d_canonical_exact(a, b, c, d) > 0;
}

}  // namespace liftmesh
