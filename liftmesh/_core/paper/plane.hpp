// The plane (a, b, p_l) of line 4 of Procedures 1 and 3, in doubles, with proven bounds on the
// rounding errors.
//
// With u = 2^-53 and z off by at most `delta`: a difference of coordinates is off by u, one of
// heights by 2 delta in addition; each component of the normal is off by no more than
//     4.01 u A + 2.01 delta B,    A_x = |ab_y| |ap_z| + |ab_z| |ap_y|,   B_x = |ab_y| + |ap_y|,
// and so on (B_z = 0), and a dot product with three products and two sums by 3.01 u more. For one
// call of a procedure ab is fixed and ap is bounded by the spread of the points, so the bounds are
// constants of the call. They are rounded up by the slack in the constants below.
#pragma once

#include <cmath>

#include "paper/points.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::paper {

struct Plane {
    double nx, ny, nz;
    double d;

    double dot(const SpacePoint& p) const { return nx * p.x + ny * p.y + nz * p.z; }
};

inline Plane plane_through(const SpacePoint& a, const SpacePoint& b, const SpacePoint& p) {
    const double abx = b.x - a.x, aby = b.y - a.y, abz = b.z - a.z;
    const double apx = p.x - a.x, apy = p.y - a.y, apz = p.z - a.z;
    Plane plane;
    plane.nx = aby * apz - abz * apy;
    plane.ny = abz * apx - abx * apz;
    plane.nz = abx * apy - aby * apx;
    plane.d = plane.dot(p);
    return plane;
}

// The error bounds of any plane through e = [a, b].
struct PlaneErrors {
    double nx, ny, nz;
    double d;
    double dot;  // of n . p - d, for every p in P

    PlaneErrors(const Points& points, Vertex a, Vertex b) {
        constexpr double u = 0x1p-53;
        const SpacePoint& spread = points.extent().spread;
        const SpacePoint& most = points.extent().greatest;
        const double delta = points.error_of_z();
        const double abx = std::fabs(points[b].x - points[a].x);
        const double aby = std::fabs(points[b].y - points[a].y);
        const double abz = std::fabs(points[b].z - points[a].z) + 2 * delta;
        const double ax = aby * spread.z + abz * spread.y;
        const double ay = abz * spread.x + abx * spread.z;
        const double az = abx * spread.y + aby * spread.x;
        // Outside the window of the filters the margin is infinite; inside, a small z may
        // underflow.
        const double least = points.guard().margin() + 1e-250;
        nx = 5 * u * ax + 3 * delta * (aby + spread.y) + least;
        ny = 5 * u * ay + 3 * delta * (abx + spread.x) + least;
        nz = 5 * u * az + least;
        d = most.x * nx + most.y * ny + most.z * nz + 2 * delta * az +
            4 * u * (ax * most.x + ay * most.y + az * most.z) + least;
        dot = 2.5 * d;
    }
};

// Line 5: whether n_z < 0, so that p_l is to the right of e as seen from above.
inline bool points_down(const Plane& plane, const PlaneErrors& errors, Point a, Point b, Point p) {
    if (plane.nz < -errors.nz) return true;
    if (plane.nz > errors.nz) return false;
    return orient2d(a, b, p) < 0;
}

}  // namespace liftmesh::paper
