// Where a straight path goes from cell to cell: exact signs of powers, which are never zero.
//
// The power of a point x by a site s is |x - s|^2 - w; x belongs to the site of least power. Along
// a segment from p to q the difference of two powers, the *gap*, changes linearly, so where it is
// zero is known from the gaps at p and q.
//
// Ties: a lexicographically larger site has an infinitesimally, and infinitely more than all
// smaller ones, larger power. This is the perturbation by which the triangulation is canonical, so
// the cells that it separates are those whose sites share an edge of the triangulation. Every
// corner of a domain then lies inside a cell, every edge crosses ridges one by one and between
// their ends, and an edge that lies along a ridge is on one side of it.
#pragma once

#include "cells/estimate.hpp"
#include "predicates/incircle.hpp"
#include "predicates/lift.hpp"

namespace liftmesh {

// The sign of the power of p by t less that by s.
template <class Lift>
int gap_sign(const Lift& lift, Point p, const Lifted<Lift>& s, const Lifted<Lift>& t, Guard guard);

// Whether p belongs to s rather than to t.
template <class Lift>
bool is_nearer(const Lift& lift, Point p, const Lifted<Lift>& s, const Lifted<Lift>& t,
               Guard guard) {
    const int side = gap_sign(lift, p, s, t, guard);
    return side != 0 ? side > 0 : before_xy(s.point, t.point);
}

struct LineSegment {
    Point from, to;
};

// The sign of the product of the segment and the step from s to t: whether the gap falls along it.
int sign_along(LineSegment segment, Point s, Point t, Guard guard);

// Along a segment on which the gaps of both t and u fall, whether that of t is zero first: whether
// it would enter the cell of t before that of u, from that of s.
template <class Lift>
bool enters_before(const Lift& lift, LineSegment segment, const Lifted<Lift>& s,
                   const Lifted<Lift>& t, const Lifted<Lift>& u, Guard guard);

// Where a segment crosses the ridge of s and t.
template <class Lift>
Estimate crossing(const Lift& lift, LineSegment segment, const Lifted<Lift>& s,
                  const Lifted<Lift>& t, Guard guard);

}  // namespace liftmesh
