// The side test of points on the unit sphere that are given as rays: vectors of any length, whose
// exact directions count. No direction is ever rounded, so all of them are on the sphere.
//
// With the unit vectors of a, b, c counter-clockwise seen from outside, ray_side() is 1 where that
// of d is above their plane, and so inside their circle, -1 where it is below. It alternates in all
// four arguments. Rows (p, |p|) have a determinant of the same sign, which is that of
//
//     |a| det(b, c, d) - |b| det(a, c, d) + |c| det(a, b, d) - |d| det(a, b, c):
//
// a sum of four integers times square roots of integers. Its sign is found by squaring.
//
// Ties: rays whose unit vectors are lexicographically larger are infinitesimally nearer to the
// centre, which decides all but circles with the centre of the sphere. Of these, larger rays are
// moved, by far less, along the last axis that leaves their plane. So the sign is 0 only if two
// rays have one direction, and lengths make no difference.
#pragma once

#include "base/double_word.hpp"
#include "predicates/orient3d.hpp"

namespace liftmesh {

struct Ray {
    SpacePoint given;
    SpacePoint unit;  // each coordinate within 4 * 2^-53

    Ray() = default;
    explicit Ray(const SpacePoint& p);
};

// The rounded direction, in double words, each coordinate within 25 * 2^-106.
struct UnitVector {
    DoubleWord<double> x, y, z;
};
UnitVector unit_vector(const SpacePoint& p);

bool have_one_direction(const SpacePoint& p, const SpacePoint& q);

// Nearly always, rounded directions tell.
inline bool have_one_direction(const Ray& p, const Ray& q) {
    constexpr double far = 0x1p-49;
    return std::fabs(p.unit.x - q.unit.x) <= far && std::fabs(p.unit.y - q.unit.y) <= far &&
           std::fabs(p.unit.z - q.unit.z) <= far && have_one_direction(p.given, q.given);
}

// An order of directions, exactly: by the face of a cube that a ray meets, and where.
bool is_direction_before(const SpacePoint& p, const SpacePoint& q);

// Without the rule for ties the sign of rays on one circle is 0.
int ray_side_unperturbed(const Ray& a, const Ray& b, const Ray& c, const Ray& d);
int ray_side_exact(const Ray& a, const Ray& b, const Ray& c, const Ray& d);

// With L the longest step, coordinates err by 4 e and steps by 9 e, so that the determinant of
// steps errs by 3 * 16 e L^2 and another 14 e L^3 for its own roundings, where L is at most 2.
inline int ray_side(const Ray& a, const Ray& b, const Ray& c, const Ray& d) {
    constexpr double bound = 80 * 0x1p-53;
    const double px = a.unit.x - d.unit.x, py = a.unit.y - d.unit.y, pz = a.unit.z - d.unit.z;
    const double qx = b.unit.x - d.unit.x, qy = b.unit.y - d.unit.y, qz = b.unit.z - d.unit.z;
    const double rx = c.unit.x - d.unit.x, ry = c.unit.y - d.unit.y, rz = c.unit.z - d.unit.z;
    const double det =
        pz * (qy * rx - qx * ry) + qz * (ry * px - rx * py) + rz * (py * qx - px * qy);
    const double length = std::max(
        {px * px + py * py + pz * pz, qx * qx + qy * qy + qz * qz, rx * rx + ry * ry + rz * rz});
    const double error = bound * length + 0x1p-1000;
    if (det > error) return 1;
    if (-det > error) return -1;
    return ray_side_exact(a, b, c, d);
}

}  // namespace liftmesh
