// The smallest sphere through the corners of an edge, a triangle or a tetrahedron in space: its
// radius, correctly rounded or compared with a limit, and what lies inside of it. Triangles of the
// plane have z = 0.
//
// With the steps u, v, w from the last corner to the others, the radius is s / 2 d, where
//
//     of an edge,         s = |u|,                                     d = 1;
//     of a triangle,      s = |u| |v| |u - v|,                         d = |u x v|;
//     of a tetrahedron,   s = | |u|^2 v x w + |v|^2 w x u + |w|^2 u x v |,   d = |u . (v x w)|.
//
// The squares of s and d are polynomials of the coordinates. So comparisons with doubles, and with
// the midpoints between doubles, are exact in integers.
#pragma once

#include "predicates/orient3d.hpp"

namespace liftmesh {

template <int K>
using Corners = std::array<SpacePoint, K>;

enum class RadiusRounding : std::uint8_t { nearest, up };

// Whether the radius is at most so large: exact for all finite corners that span the simplex, and
// any limit that is not negative.
template <int K>
bool is_radius_at_most(const Corners<K>& corners, double limit);

// Correctly rounded; infinite where the nearest double would be, or none is as large. By `up` it is
// the least double that is not less: so it is at most a double exactly if the radius is.
template <int K>
double circumradius(const Corners<K>& corners, RadiusRounding rounding);
// The same of two, side by side, which takes little more time than of one.
template <int K>
std::array<double, 2> circumradii(const std::array<Corners<K>, 2>& corners,
                                  RadiusRounding rounding);

// Whether p lies strictly inside the smallest sphere through the ends of an edge or the corners of
// a triangle, in any order; exact.
bool is_inside_smallest_sphere(const Corners<2>& ends, const SpacePoint& p);
bool is_inside_smallest_sphere(const Corners<3>& corners, const SpacePoint& p);

}  // namespace liftmesh
