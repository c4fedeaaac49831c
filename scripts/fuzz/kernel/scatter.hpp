// Distinct finite points with heights, for what is asked of surfaces and terrains.
#pragma once

#include <cstddef>
#include <vector>

#include "base/input.hpp"
#include "base/point.hpp"
#include "bytes.hpp"
#include "predicates/orient3d.hpp"

namespace fuzzing {

using liftmesh::Point;
using liftmesh::SpacePoint;

struct Scatter {
    std::vector<Point> points;
    std::vector<double> heights;
    bool is_wide = false;  // so many magnitudes that signs take the longest integers

    std::size_t size() const { return points.size(); }
    SpacePoint at(std::size_t row) const { return {points[row].x, points[row].y, heights[row]}; }
    liftmesh::Input input() const;
    // Row i of the result is row order[i].
    Scatter in_order(const std::vector<std::size_t>& order) const;
};

// As many as the bytes have, up to a number, or a few if they are wide.
Scatter scatter(Bytes& bytes, std::size_t most);

// A raster whose columns and rows are a step apart, within rounding; some pixels are missing.
Scatter raster_scatter(Bytes& bytes);

// Points of a small lattice that is turned by the ratio 1 : 2, and the middles of two of them: many
// are on edges, exactly. Heights have few values.
Scatter turned_scatter(Bytes& bytes, std::size_t most);

// Whether the magnitudes of points are outside the window of the in-circle filter.
bool are_wide(const std::vector<Point>& points);

// The numbers below a count, in any order.
std::vector<std::size_t> shuffled(std::size_t count, Dice& dice);

// Whether a point is in a closed triangle, exactly.
bool contains(const Point (&corners)[3], Point query);

}  // namespace fuzzing
