// The same signs in floating point, with a bound on what rounding may have changed.
//
// Let u = 2^-53, and L the sum of |x|, |y| and |r| of a row, so that P is off by at most 5 u L^2.
// In absolute values, the minors xp, yp, rp of two rows are at most M3 = Lq Lr^2 + Lr Lq^2, those
// without P at most M2 = Lq Lr, those of three rows at most M4 = Lt M3 + Lt^2 M2; and
// |xp| + |yp| <= M3. Counting roundings, `distance` is off by less than 24 u M3 M4 in its even and
// 12 u M4 in its odd part, `turn` by less than 18 u M3 N3 Lq^2... in terms of the minors of both
// pairs. The root is a product of three powers: its relative error is half the sum of theirs, of
// 5 u L^2 / P each, and 3 u. The constants below are larger by a third at least, for what is of
// second order. (For infinity, L = 0, and 1 stands for L^2.)
#pragma once

#include "apollonius/disk.hpp"
#include "apollonius/polynomials.hpp"

namespace liftmesh::apollonius {

// A row, its L, and the bound of its power.
struct Bounded : Relative<double> {
    double length, square;

    Bounded(const Disk& base, const Disk& d) {
        if (d.is_infinity) {
            x = y = r = length = 0;
            power = square = 1;
            return;
        }
        x = d.x - base.x;
        y = d.y - base.y;
        r = d.r - base.r;
        power = power_of(x, y, r);
        length = std::fabs(x) + std::fabs(y) + std::fabs(r);
        square = length * length;
    }

    // Whether the power is surely positive, and the bound of its relative error is usable.
    bool is_apart() const { return power > 1e-12 * square; }
    double looseness() const { return square / power; }
};

inline constexpr double unit = 0x1p-53;

// The minors of two rows, with their bounds and the root.
struct BoundedCircle : Minors<double> {
    double of_two, of_three, root = 0, looseness = 0;
    bool is_sure;

    BoundedCircle(const Bounded& q, const Bounded& r, bool r_is_infinity)
        : Minors<double>(q, r),
          of_two(q.length * r.length),
          of_three(q.length * r.square + r.length * q.square),
          is_sure(q.is_apart() && r.is_apart()) {
        if (!is_sure) return;
        double radicand = q.power;
        looseness = q.looseness();
        if (!r_is_infinity) {
            const double x = q.x - r.x, y = q.y - r.y, more = q.r - r.r;
            // The rows were rounded before: their own lengths bound what that changes.
            const double length = q.length + r.length;
            const double power = power_of(x, y, more);
            is_sure = power > 1e-12 * length * length;
            radicand *= r.power * power;
            looseness += r.looseness() + length * length / power;
        }
        if (is_sure) root = std::sqrt(radicand);
    }

    // The bound of rounding of a root times a factor.
    double of_root(double factor) const { return std::fabs(factor) * root * (6 * looseness + 6); }
};

// -1, 1, or 0 where rounding may have decided.
inline int sure_sign(double value, double bound) {
    return value > bound ? 1 : value < -bound ? -1 : 0;
}

inline int filtered_distance(const BoundedCircle& c, const Bounded& t) {
    if (!c.is_sure || !t.is_apart()) return 0;
    const Surd<double> d = distance<double>(c, t);
    const double of_four = t.length * c.of_three + t.square * c.of_two;
    const double bound = unit * (of_four * (32 * c.of_three + 16 * c.root) + c.of_root(d.odd));
    return sure_sign(d.even + d.odd * c.root, bound);
}

}  // namespace liftmesh::apollonius
