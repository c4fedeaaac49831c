// What Procedures 1 and 3 share: the points, the exact predicate where doubles are inconclusive,
// and the counts.
#pragma once

#include "base/status.hpp"
#include "paper/points.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::paper {

// Counts of the steps of the procedures.

struct Counts {
    std::uint64_t calls = 0;             // of the procedure: edges wrapped around
    std::uint64_t candidate_planes = 0;  // planes (a, b, p_l) with n_z < 0
    std::uint64_t evaluations = 0;       // points held against a plane by a dot product
    std::uint64_t rejected[6] = {};      // by Propositions 4.3 (i)-(v), and 4.4
    std::uint64_t undecided = 0;         // evaluations that the exact predicate decided
};

// The plane (a, b, p_l) of line 4 of Procedures 1 and 3, in doubles, with proven bounds on the
// rounding errors.
//
// With u = 2^-53 and z off by at most `delta`: a difference of coordinates is off by u, one of
// heights by 2 delta in addition; each component of the normal is off by no more than
//     4.01 u A + 2.01 delta B,    A_x = |ab_y| |ap_z| + |ab_z| |ap_y|,   B_x = |ab_y| + |ap_y|,
// and so on (B_z = 0), and a dot product with three products and two sums by 3.01 u more. For one
// call of a procedure ab is fixed and ap is bounded by the spread of the points, so the bounds are
// constants of the call. They are rounded up by the slack in the constants below.

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

// The restricted region of Section 4: lines 6 and 7 of Procedure 3, rounded outwards.
//
// The printed formulas, each followed by a bound on its rounding error: alpha = -n_x / n_z is off
// by at most (E(n_x) + |alpha| E(n_z)) / (|n_z| - E(n_z)) for the errors E of a plane, and so on
// down to r. Every bound is rounded away from the circle, so a point that Proposition 4.3 rejects
// is above the plane, and one that Proposition 4.4 rejects is below it, whatever q is. A q so far
// away that no digits are left gives an unbounded region, which rejects nothing.

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

template <class Points>
class FacetSearch {
 public:
    FacetSearch(const Points& points, Interrupt& interrupt) : p_(points), patience_(interrupt) {}

    const Counts& counts() const { return counts_; }
    bool interrupted() { return patience_.ends(0); }

 protected:
    // For inconclusive evaluations; it takes up to a hundred times as long as a dot product. a, b
    // and p_l are not candidates for p: they are on the plane, so only here need they be excluded.
    bool is_below(Vertex a, Vertex b, Vertex l, Vertex v) {
        if (v == a || v == b || v == l) return false;
        ++counts_.undecided;
        patience_.ends(64);
        return p_.is_below(a, b, l, v);
    }

    // How many of a, b and p_l are among the first `count` points: P \ {a, b, p_l} excludes them.
    static std::uint64_t members_of_plane(Vertex a, Vertex b, Vertex l, Vertex count) {
        return std::uint64_t{a < count} + (b < count) + (l < count);
    }

    const Points& p_;
    Patience patience_;
    Counts counts_;
};

// Procedure 1: LF(e, P), the lower facet to the right of an edge.

template <class Points>
class Lf : public FacetSearch<Points> {
    using FacetSearch<Points>::p_, FacetSearch<Points>::patience_, FacetSearch<Points>::counts_;

 public:
    Lf(const Points& points, Interrupt& interrupt) : FacetSearch<Points>(points, interrupt) {}

    // The third vertex p_l of the facet (a, b, p_l). None if e is a bound-edge, for which the paper
    // returns e.
    std::optional<Vertex> operator()(Vertex a, Vertex b) {
        ++counts_.calls;
        const PlaneErrors errors(p_, a, b);
        const auto n = static_cast<Vertex>(p_.size());
        for (Vertex l = 0; l < n && !patience_.ends(); ++l) {        // lines 1, 9, 10
            if (l == a || l == b) continue;                          // lines 2, 3
            const Plane plane = plane_through(p_[a], p_[b], p_[l]);  // line 4
            if (!points_down(plane, errors, p_.planar(a), p_.planar(b), p_.planar(l)))
                continue;  // line 5
            ++counts_.candidate_planes;
            if (!any_below(plane, errors.dot, a, b, l)) return l;  // lines 6, 7, 8
        }
        return std::nullopt;  // line 11
    }

 private:
    // n . p > d means that p is below. Within the error of the dot product the exact predicate
    // decides.
    bool any_below(const Plane plane, double error, Vertex a, Vertex b, Vertex l) {
        const SpacePoint* const p = p_.data();
        const auto n = static_cast<Vertex>(p_.size());
        Vertex v = 0;
        for (; v < n; ++v) {
            const double side = plane.dot(p[v]) - plane.d;
            if (side < -error) continue;
            if (side > error || this->is_below(a, b, l, v)) break;
        }
        const bool found = v < n;
        const Vertex evaluated = v + found;
        counts_.evaluations += evaluated - this->members_of_plane(a, b, l, evaluated);
        patience_.ends(evaluated);
        return found;
    }
};

// Procedure 3: LFRes(e, P), which is LF(e, P) with the restricted region.

class LfRes : public FacetSearch<LiftedPoints> {
 public:
    using FacetSearch::FacetSearch;

    std::optional<Vertex> operator()(Vertex a, Vertex b) {
        ++counts_.calls;
        const PlaneErrors errors(p_, a, b);
        const auto n = static_cast<Vertex>(p_.size());
        for (Vertex l = 0; l < n && !patience_.ends(); ++l) {        // lines 1, 12, 13
            if (l == a || l == b) continue;                          // lines 2, 3
            const Plane plane = plane_through(p_[a], p_[b], p_[l]);  // line 4
            if (!points_down(plane, errors, p_.planar(a), p_.planar(b), p_.planar(l)))
                continue;  // line 5
            ++counts_.candidate_planes;
            const Region region(plane, errors, p_.q(), p_.error_of_z());   // lines 6, 7
            if (!any_below(plane, region, errors.dot, a, b, l)) return l;  // lines 8 to 11
        }
        return std::nullopt;  // line 14
    }

 private:
    bool any_below(const Plane& plane, const Region& region, double error, Vertex a, Vertex b,
                   Vertex l) {
        const SpacePoint* const p = p_.data();
        const auto n = static_cast<Vertex>(p_.size());
        Vertex k = 0, evaluated = 0;
        for (;; ++k) {
            k = next_in_region(p, k, n, region, counts_.rejected);
            if (k == n || p[k].z < region.min_z) break;  // line 9
            ++evaluated;
            const double side = plane.dot(p[k]) - plane.d;  // line 10
            if (side < -error) continue;
            if (side > error || is_below(a, b, l, k)) break;
        }
        counts_.evaluations += evaluated - members_of_plane(a, b, l, std::min(k + 1, n));
        patience_.ends(k);
        return k < n;
    }
};

}  // namespace liftmesh::paper
