// The side test of a lifted point against a lifted plane, decided in the plane.
//
// incircle(a, b, c, d) for counter-clockwise a, b, c: +1 where d lies inside their circle (its lift
// is below the plane of the other three), -1 outside, 0 on the circle.
//
// The filter is Shewchuk's: |error| <= (10 + 96e) e permanent. It holds where no intermediate
// underflows or overflows, which `Guard` vouches for.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// Whether every non-zero coordinate lies in [2^-140, 2^200]. Then differences are zero or at least
// 2^-192, values computed from two of them zero or at least 2^-436, terms of degree four zero or in
// [2^-872, 2^810], and the filters need no further care; elsewhere they certify nothing and the
// exact ladder decides.
class Guard {
 public:
    static constexpr int least_exponent = -140;
    static constexpr int greatest_exponent = 200;

    static constexpr Guard in_window() { return Guard(0.0); }
    static constexpr Guard anywhere() { return Guard(std::numeric_limits<double>::infinity()); }
    double margin() const { return margin_; }
    bool vouches() const { return margin_ == 0.0; }

 private:
    constexpr explicit Guard(double margin) : margin_(margin) {}
    double margin_;
};

// Both are exact for all finite doubles; called where the filter below is inconclusive.
int incircle_exact(Point a, Point b, Point c, Point d, Guard guard);
int incircle_canonical_exact(Point a, Point b, Point c, Point d, Guard guard);

struct InCircleFilter {
    double det, error;
};

inline InCircleFilter incircle_filter(Point a, Point b, Point c, Point d) {
    constexpr double e = 0x1p-53;
    constexpr double bound = (10 + 96 * e) * e;
    const double adx = a.x - d.x, ady = a.y - d.y;
    const double bdx = b.x - d.x, bdy = b.y - d.y;
    const double cdx = c.x - d.x, cdy = c.y - d.y;
    const double bc = bdx * cdy, cb = cdx * bdy;
    const double ca = cdx * ady, ac = adx * cdy;
    const double ab = adx * bdy, ba = bdx * ady;
    const double alift = adx * adx + ady * ady;
    const double blift = bdx * bdx + bdy * bdy;
    const double clift = cdx * cdx + cdy * cdy;
    const double det = alift * (bc - cb) + blift * (ca - ac) + clift * (ab - ba);
    const double permanent = alift * (std::fabs(bc) + std::fabs(cb)) +
                             blift * (std::fabs(ca) + std::fabs(ac)) +
                             clift * (std::fabs(ab) + std::fabs(ba));
    return {det, bound * permanent};
}

// The canonical test: as incircle, but a point on the circle is decided by the symbolic
// perturbation that lifts lexicographically larger points more. Never 0 for distinct points.
inline bool incircle_canonical(Point a, Point b, Point c, Point d, Guard guard) {
    const InCircleFilter filter = incircle_filter(a, b, c, d);
    const double error = filter.error + guard.margin();
    if (filter.det > error) return true;
    if (-filter.det > error) return false;
    return incircle_canonical_exact(a, b, c, d, guard) > 0;
}

// The symbolic perturbation, which is the rule for ties: the sign where a lifted point lies exactly
// on the plane of three others. It is used by incircle, orient3d, lifted_side and
// verify/edge_pairing. The same rule has other forms in space (insphere.cpp), along a segment
// between cells (`perturbed_order` in cells/power_side.cpp) and for the paper's first edge, which
// compares heights (paper/algorithm2.hpp). Disks have a rule of their own (apollonius/disk.hpp).
//
// The sign of incircle(a, b, c, d), or of orient3d, once lexicographically larger points (by x,
// then y) are lifted by an infinitesimal more. It is 0 only if a, b, c are collinear or d coincides
// with one of them.
int perturbed_sign(Point a, Point b, Point c, Point d);

}  // namespace liftmesh
