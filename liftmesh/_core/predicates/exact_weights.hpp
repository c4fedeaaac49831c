// Weights of a point in a triangle, and the slopes of a face, from exact determinants: each has an
// error of a few units in the last place, whatever the shape and the size of the triangle. For
// triangles so thin, small or large that rounded determinants do not do.
#pragma once

#include "base/point.hpp"

namespace liftmesh {

// The weights of b and c; that of a is what is missing to 1.
struct Weights {
    double of_b, of_c;
};

Weights exact_weights(Point a, Point b, Point c, Point query);

// Of the plane through three points with heights: dz/dx and dz/dy. Each is the quotient of two
// determinants: of z and y, or x and z, and of x and y.
Point exact_slopes(const Point (&corners)[3], const double (&heights)[3]);

}  // namespace liftmesh
