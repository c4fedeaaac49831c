// The Delaunay triangulation of points on the sphere: the convex hull of the unit vectors of rays.
#pragma once

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "base/status.hpp"
#include "sorting/space_order.hpp"

namespace liftmesh {

struct SphereResult {
    Status status = Status::ok;
    std::size_t row = 0;       // the first non-finite row, where that is the status
    std::size_t distinct = 0;  // how many directions there are
    std::vector<Duplicate> duplicates;
    std::vector<Row> skipped;
    std::vector<std::array<std::int32_t, 3>> simplices, neighbors;
};

// By incremental insertion: a point replaces the facets that it is above. Facets are found by a
// visibility walk. Seen from one of the points, s, the sphere is a plane (a stereographic
// projection), in which circles stay circles, s is far away and the facets at s are those of the
// hull; whether a point is left of an edge is on which side of s the circle through all three is.
// So one predicate, ray_side(), decides everything.
//
// No row may be zero. Facets are counter-clockwise seen from outside, in the order of the curve, by
// their least vertex, with which they begin, then the others.
SphereResult triangulate_sphere(const Input& input, bool skip_non_finite, std::uint64_t secret,
                                Interrupt& interrupt);

// The centres of the circles of facets, on their side of the sphere: unit vectors, each coordinate
// within some units in the last place of 1.
bool find_circle_centres(const SpacePoint* points, const std::int32_t* simplices, std::size_t count,
                         Interrupt& interrupt, SpacePoint* centres);

// The facets around each row, counter-clockwise, from the one that comes first: those of row i are
// facets[starts[i]] to facets[starts[i + 1]].
struct SphereCells {
    std::vector<std::int32_t> starts, facets;
};
bool find_sphere_cells(const std::int32_t* simplices, const std::int32_t* neighbors,
                       std::size_t count, std::size_t rows, Interrupt& interrupt,
                       SphereCells& cells);

}  // namespace liftmesh
