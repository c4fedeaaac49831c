// The restricted region of Section 4: lines 6 and 7 of Procedure 3, rounded outwards.
//
// The printed formulas, each followed by a bound on its rounding error: alpha = -n_x / n_z is off
// by at most (E(n_x) + |alpha| E(n_z)) / (|n_z| - E(n_z)) for the errors E of a plane, and so on
// down to r. Every bound is rounded away from the circle, so a point that Proposition 4.3 rejects
// is above the plane, and one that Proposition 4.4 rejects is below it, whatever q is. A q so far
// away that no digits are left gives an unbounded region, which rejects nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "paper/plane.hpp"

namespace liftmesh::paper {

struct Region {
    static constexpr double inf = std::numeric_limits<double>::infinity();

    double min_x = -inf, max_x = inf;
    double min_y = -inf, max_y = inf;
    double min_z = -inf, max_z = inf;  // min_z = -inf where L_cq >= r

    Region(const Plane& plane, const PlaneErrors& errors, Point q, double error_of_z) {
        constexpr double u = 0x1p-53;
        const double per_nz = 1 / plane.nz;
        const double alpha = -plane.nx * per_nz;
        const double beta = -plane.ny * per_nz;
        const double gamma = plane.d * per_nz;
        const double l_cq2 = 0.25 * (alpha * alpha + beta * beta);
        const double l_cq = std::sqrt(l_cq2);
        const double r2 = gamma + alpha * q.x + beta * q.y + l_cq2;

        const double rest = std::fabs(plane.nz) - errors.nz;
        if (!(rest > errors.nz)) return;
        const double per_rest = 1 / rest;
        const double a = std::fabs(alpha), b = std::fabs(beta), g = std::fabs(gamma);
        const double e_alpha = (errors.nx + a * errors.nz) * per_rest + 4 * u * a;
        const double e_beta = (errors.ny + b * errors.nz) * per_rest + 4 * u * b;
        const double e_gamma = (errors.d + g * errors.nz) * per_rest + 4 * u * g;
        const double e_c = 0.5 * (e_alpha + e_beta);  // of c_x, of c_y, and of L_cq
        const double qx = std::fabs(q.x), qy = std::fabs(q.y);
        const double e_r2 = e_gamma + qx * e_alpha + qy * e_beta + e_c * (2 * l_cq + e_c) +
                            8 * u * (g + a * qx + b * qy + l_cq2);
        if (!(e_r2 < inf)) return;

        const double r = std::sqrt(std::max(r2, 0.0) + e_r2) * (1 + 4 * u);
        const double l = l_cq * (1 + 8 * u) + e_c;
        const double c_x = q.x + 0.5 * alpha, c_y = q.y + 0.5 * beta;
        const double reach = r + e_c + 4 * u * (qx + qy + a + b + r);
        min_x = c_x - reach;
        max_x = c_x + reach;
        min_y = c_y - reach;
        max_y = c_y + reach;
        max_z = (l + r) * (l + r) * (1 + 8 * u) + 2 * error_of_z;
        if (!(l * l < r2 - e_r2)) return;
        const double inner = std::sqrt(r2 - e_r2) * (1 - 4 * u);
        if (l < inner) min_z = (inner - l) * (inner - l) * (1 - 8 * u) - 2 * error_of_z;
    }
};

// The first point from `k` on that Propositions 4.3 and 4.4 do not decide, or that 4.4 finds below
// the plane; `count` if there is none. A rejected point counts for the first proposition, in the
// printed order, that rejects it.
inline Vertex next_in_region(const SpacePoint* p, Vertex k, Vertex count, const Region& region,
                             std::uint64_t (&rejected)[6]) {
    const Region bounds = region;
    std::uint64_t i = 0, ii = 0, iii = 0, iv = 0, v = 0;
    for (; k < count; ++k) {
        const auto [x, y, z] = p[k];
        if (z < bounds.min_z) {
            ++rejected[5];
            break;
        }
        if (x < bounds.min_x) {
            ++i;
        } else if (x > bounds.max_x) {
            ++ii;
        } else if (y < bounds.min_y) {
            ++iii;
        } else if (y > bounds.max_y) {
            ++iv;
        } else if (z > bounds.max_z) {
            ++v;
        } else {
            break;
        }
    }
    rejected[0] += i;
    rejected[1] += ii;
    rejected[2] += iii;
    rejected[3] += iv;
    rejected[4] += v;
    return k;
}

}  // namespace liftmesh::paper
