// The corners of Voronoi and power cells (power_centre.cpp), each coordinate the double nearest to
// the exact one; and the exact signs of powers along segments (power_side.cpp).
//
// The point of equal power to three weighted sites is where the planes that belong to them meet;
// without weights it is the centre of their circle. With heights h = |p|^2 - w,
//
//     x = sum h_i (y_j - y_k) / 2 sum x_i (y_j - y_k)        (i, j, k in turn)
//
// and y alike, with x_k - x_j in the place of y_j - y_k; the denominator is four times the area.
//
// Steps, each for what the one before leaves open:
//
// 1. The step from the first site to the centre, with a bound on its error: in doubles, which is
//    enough where the step is short, then in double words. The result is certain if both ends of
//    the interval round to the same double. With double words that fails for one of 2^40 generic
//    coordinates, and where the centre lies halfway between two doubles.
// 2. The centre of a right-angled axis-parallel triangle, as in every cell of a raster, is the
//    middle of two coordinates: one addition.
// 3. Comparisons with the midpoints between doubles, exact in 256 bits where the coordinates of the
//    sites are machine integers on one lattice.
// 4. The same by sums of products of mantissas, for all finite doubles. If m is the middle of the
//    doubles c and c', the sign of x - m is that of sum (h_i - c x_i - c' x_i) (y_j - y_k).
#pragma once

#include "base/double_word.hpp"
#include "predicates/incircle.hpp"
#include "predicates/lift.hpp"

namespace liftmesh {

inline constexpr double unknown = std::numeric_limits<double>::infinity();

// Whether the filters hold for a site: its coordinates are in the window of `Guard`, its radius is,
// and its weight in that of their squares.
template <class Lift>
bool is_in_window(const Lifted<Lift>& site);

// Of three sites that turn counter-clockwise. Infinite where the nearest double would be.
template <class Lift>
Point power_centre(const Lift& lift, const Lifted<Lift> (&sites)[3], Guard guard);

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
