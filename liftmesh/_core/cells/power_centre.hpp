// The corners of Voronoi and power cells: each coordinate is the double nearest to the exact one.
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

#include "predicates/incircle.hpp"
#include "predicates/lift.hpp"

namespace liftmesh {

// Whether the filters hold for a site: its coordinates are in the window of `Guard`, its radius is,
// and its weight in that of their squares.
template <class Lift>
bool is_in_window(const Lifted<Lift>& site);

// Of three sites that turn counter-clockwise. Infinite where the nearest double would be.
template <class Lift>
Point power_centre(const Lift& lift, const Lifted<Lift> (&sites)[3], Guard guard);

}  // namespace liftmesh
