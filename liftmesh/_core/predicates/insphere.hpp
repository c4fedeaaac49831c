// Orientation in space and the side test of a sphere, as tetrahedra need them: for whole sets of
// points, whose filters have bounds that are computed beforehand.
//
// volume_sign(a, b, c, d): +1 where d sees a, b, c turn counter-clockwise, so that the tetrahedron
// is positive; -1 where clockwise, 0 where the four are coplanar. (orient3d() has the opposite
// sign: it asks whether d is below.) insphere(a, b, c, d, e) for a positive tetrahedron: +1 where e
// lies inside its sphere, -1 outside, 0 on it.
//
// The filters evaluate Shewchuk's expressions, whose errors are at most (7 + 56e) e and
// (16 + 224e) e of the permanents, with e = 2^-53. Let X, Y and Z be the largest differences along
// the axes, and L the greatest square of a distance. The permanents are at most 6 X Y Z and
// 24 X Y Z L, and the bounds themselves are off by less than one part in 10^14: 43 e X Y Z and
// 386 e X Y Z L suffice; as
// X Y Z <= L^1.5, so does 387 e L^2.5, which is known sooner. That holds where nothing underflows
// or overflows: with coordinates zero or in [2^-131, 2^200], a sum of terms of degree k is zero or
// at least 2^-(183 k + 52 (k - 1)), terms of degree five are at least 2^-1022, and below 2^1012.
//
// Where all coordinates are multiples of a unit u and differences are at most 2^9 u, each
// intermediate is an integer multiple of a power of u, below 2^53 of it: |det| <= 72 * 2^45. So
// nothing is rounded, and the sign is exact, 0 as well. For a volume, 2^16 u will do. Most ties of
// lattices are decided so.
#pragma once

#include "predicates/orient3d.hpp"

namespace liftmesh {

// The corners of facet k of a positive tetrahedron, opposite corner k, counter-clockwise seen from
// outside.
inline constexpr unsigned outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// What is known of the points of a set.
struct Trust {
    static constexpr int least_exponent = -131;

    Guard guard = Guard::anywhere();
    // Differences, and squares of distances, up to which nothing is rounded. A square may be 0 by
    // underflow.
    double exact_volume = 0, exact_square = -1;
    double to_integers = 0;  // makes all coordinates integers below 2^61, if not zero

    // `unit` divides all coordinates, of which none is larger than `largest`.
    static Trust of(Guard guard, double unit, double largest) {
        if (!guard.vouches()) return {};
        return {guard, 0x1p16 * unit, 0x1p18 * unit * unit, largest < 0x1p61 * unit ? 1 / unit : 0};
    }
};

// These are exact for all finite doubles; called where the filters below are inconclusive.
int volume_sign_exact(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                      const SpacePoint& d, const Trust& trust);
int insphere_exact(const SpacePoint (&points)[5], const Trust& trust);
// Once lexicographically larger points (by x, then y, then z) are lifted by an infinitesimal more.
// It is 0 only if the first four are coplanar or the last coincides with one of them.
int insphere_canonical_exact(const SpacePoint (&points)[5], const Trust& trust);
// The same for distinct points on one sphere, of which the first four are a positive tetrahedron.
bool is_inside_by_rule(const std::array<const SpacePoint*, 5>& points, const Trust& trust);

// The same from the volumes with each of the first four replaced by the last: of the points whose
// lift counts the largest decides, and the last one's always counts.
inline bool is_inside_by_rule(const std::array<const SpacePoint*, 5>& points,
                              const double (&volumes)[4]) {
    const SpacePoint* largest = points[4];
    double volume = -1;
    for (unsigned i = 0; i < 4; ++i) {
        const bool is_larger = (volumes[i] != 0) & before_xyz(*largest, *points[i]);
        largest = is_larger ? points[i] : largest;
        volume = is_larger ? volumes[i] : volume;
    }
    return volume > 0;
}

struct SpaceSteps {
    double x, y, z;

    SpaceSteps(const SpacePoint& to, const SpacePoint& from)
        : x(to.x - from.x), y(to.y - from.y), z(to.z - from.z) {}
    double square() const { return x * x + y * y + z * z; }
};

inline constexpr double sphere_bound = 387 * 0x1p-53;

inline double largest_magnitude(double a, double b, double c) {
    return std::max(std::max(std::fabs(a), std::fabs(b)), std::fabs(c));
}

inline int volume_sign(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                       const SpacePoint& d, const Trust& trust) {
    constexpr double bound = 43 * 0x1p-53;
    const SpaceSteps p(a, d), q(b, d), r(c, d);
    const double det = p.z * (q.y * r.x - q.x * r.y) + q.z * (r.y * p.x - r.x * p.y) +
                       r.z * (p.y * q.x - p.x * q.y);
    const double x = largest_magnitude(p.x, q.x, r.x), y = largest_magnitude(p.y, q.y, r.y);
    const double z = largest_magnitude(p.z, q.z, r.z);
    if (std::max(std::max(x, y), z) <= trust.exact_volume) return (det > 0) - (det < 0);
    const double error = bound * x * y * z + trust.guard.margin();
    if (det > error) return 1;
    if (-det > error) return -1;
    return volume_sign_exact(a, b, c, d, trust);
}

struct SphereFilter {
    double det, square;  // L
    double volumes[4];   // with each corner of the tetrahedron replaced by the fifth point
};

// From the differences to the fifth point.
inline SphereFilter insphere_filter(const SpaceSteps& p, const SpaceSteps& q, const SpaceSteps& r,
                                    const SpaceSteps& s) {
    const double pq = p.x * q.y - q.x * p.y, qr = q.x * r.y - r.x * q.y;
    const double rs = r.x * s.y - s.x * r.y, sp = s.x * p.y - p.x * s.y;
    const double pr = p.x * r.y - r.x * p.y, qs = q.x * s.y - s.x * q.y;
    const double pqr = p.z * qr - q.z * pr + r.z * pq;
    const double qrs = q.z * rs - r.z * qs + s.z * qr;
    const double rsp = r.z * sp + s.z * pr + p.z * rs;
    const double spq = s.z * pq + p.z * qs + q.z * sp;
    const double of_p = p.square(), of_q = q.square(), of_r = r.square(), of_s = s.square();
    const double det = (of_r * spq - of_s * pqr) + (of_p * qrs - of_q * rsp);
    return {det, std::max(std::max(of_p, of_q), std::max(of_r, of_s)), {qrs, -rsp, spq, -pqr}};
}

// For points that all differ little along some axis.
inline double insphere_error(const SpaceSteps& p, const SpaceSteps& q, const SpaceSteps& r,
                             const SpaceSteps& s, double square) {
    const double x = std::max(largest_magnitude(p.x, q.x, r.x), std::fabs(s.x));
    const double y = std::max(largest_magnitude(p.y, q.y, r.y), std::fabs(s.y));
    const double z = std::max(largest_magnitude(p.z, q.z, r.z), std::fabs(s.z));
    return sphere_bound * (x * y) * (z * square);
}

// Whether e is inside the sphere of a positive tetrahedron, or on it and inside by the rule; from
// the filter of their differences.
inline bool is_inside_sphere(const SphereFilter& filter, const SpacePoint& a, const SpacePoint& b,
                             const SpacePoint& c, const SpacePoint& d, const SpacePoint& e,
                             const Trust& trust) {
    const auto& [det, square, volumes] = filter;
    if (square <= trust.exact_square)
        return det != 0 ? det > 0 : is_inside_by_rule({&a, &b, &c, &d, &e}, volumes);
    const double error = sphere_bound * square * square * std::sqrt(square) + trust.guard.margin();
    if (det > error) return true;
    if (-det > error) return false;
    const double closer =
        insphere_error({a, e}, {b, e}, {c, e}, {d, e}, square) + trust.guard.margin();
    if (det > closer) return true;
    if (-det > closer) return false;
    const int sign = insphere_exact({a, b, c, d, e}, trust);
    return sign != 0 ? sign > 0 : is_inside_by_rule({&a, &b, &c, &d, &e}, trust);
}
inline bool is_inside_sphere(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                             const SpacePoint& d, const SpacePoint& e, const Trust& trust) {
    return is_inside_sphere(insphere_filter({a, e}, {b, e}, {c, e}, {d, e}), a, b, c, d, e, trust);
}

}  // namespace liftmesh
