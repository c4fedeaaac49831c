// A disk, and the exact signs by which the graph of disks is built.
//
// Coordinates and radii are at most 1, and multiples of a power of two that is at least 2^-256
// (`apollonius.cpp` scales them). No sign is rounded, and none is zero where four disks touch one
// circle: of these, the one of least radius counts as infinitesimally smaller, or the one of those
// whose centre comes last by x, then y. Infinity counts as larger, by far more: circles of infinite
// radius are none.
#pragma once

#include "base/point.hpp"

namespace liftmesh::apollonius {

struct Disk {
    double x, y, r;
    bool is_infinity = false;

    bool operator==(const Disk&) const = default;
};

inline constexpr Disk infinity{0, 0, 0, true};

class Signs {
 public:
    // With `filters`, floating point decides where it provably can. Then coordinates must be
    // multiples of 2^-130: products of seven differences do not underflow.
    explicit Signs(bool filters) : filters_(filters) {}

    // Whether a contains b: b touches its boundary from inside at most.
    bool contains(const Disk& a, const Disk& b) const;

    // Whether t is nearer to the centre of the circle that touches p, q and r in counter-clockwise
    // order than they are. Where one of the four is contained in another, it is farther.
    bool conflicts(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const;

    // Whether the two circles that touch p, q and t lie on the Voronoi edge of p and q from the
    // circle of p, q, r to that of q, p, s, if t conflicts with both of these or with none.
    bool within_edge(const Disk& p, const Disk& q, const Disk& r, const Disk& s,
                     const Disk& t) const;

    // The same questions without the rule for ties. How far t is from the circle of p, q and r: -1
    // where it conflicts, 0 if it touches it.
    int distance_from(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const;
    // Whether t, which touches the circle of p, q and r, does so between p and q.
    bool touches_between(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const;
    // Whether the circles that touch p and q and conflict with s, t and r, which are disjoint sets
    // of them, have this counter-clockwise order.
    bool in_order(const Disk& p, const Disk& q, const Disk& s, const Disk& t, const Disk& r) const;

    // Of the direction right after that of the x-axis, counter-clockwise: whether d reaches beyond
    // the tangent of p that has it as its outer normal.
    bool reaches_beyond(const Disk& p, const Disk& d) const;
    // If neither s nor r does, and no direction has both beyond it: whether the counter-clockwise
    // order is those of s, this one, those of r.
    bool is_between(const Disk& p, const Disk& s, const Disk& r) const;

 private:
    bool breaks_tie(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const;

    bool filters_;
};

// The circle that touches three disks: its centre and its radius, which is negative if it lies
// within each of them. With infinity among them, (x, y) is the direction of its centre. Rounded.
struct Circle {
    double x, y, radius;
};
Circle touching(const Disk& p, const Disk& q, const Disk& r);
// The same of finite disks, from integers where doubles may leave few digits, or none.
Circle surely_touching(const Disk& p, const Disk& q, const Disk& r);

}  // namespace liftmesh::apollonius
