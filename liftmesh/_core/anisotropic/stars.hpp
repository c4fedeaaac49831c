// The stars of all points, each in the metric of its own.
#pragma once

#include "anisotropic/ellipse.hpp"
#include "base/point.hpp"
#include "base/status.hpp"

namespace liftmesh::anisotropic {

// Of each row a range of rows: starts holds one more than there are.
struct Lists {
    std::vector<std::int64_t> starts;
    std::vector<std::int32_t> rows;
};

// From the Euclidean Delaunay triangulation: the neighbours of each row (none of rows that are no
// vertices), and the edges of its hull, counter-clockwise. False if the interrupt came first.
struct Given {
    std::span<const Point> points;
    std::span<const Metric> metrics;
    std::span<const std::int32_t> starts, neighbors;
    std::span<const std::int32_t> hull;  // pairs
};
bool stars(const Given& given, Interrupt& interrupt, Lists& found);

}  // namespace liftmesh::anisotropic
