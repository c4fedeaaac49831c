// Which tetrahedra contain given points.
#pragma once

#include "base/status.hpp"
#include "sorting/space_order.hpp"

namespace liftmesh {

// A finished triangulation of a convex region: rows of points, tetrahedra over them, and what is
// across each facet, -1 beyond the hull.
struct SpaceTriangulation {
    const SpacePoint* points;
    std::size_t rows;
    const std::int32_t* simplices;  // count x 4
    const std::int32_t* neighbors;
    std::size_t count;
};

class SpaceLocator {
 public:
    explicit SpaceLocator(const SpaceTriangulation& tetrahedra);

    // For each query the first tetrahedron that contains it, -1 if none does. False if the
    // interrupt came first.
    bool find(const SpacePoint* queries, std::size_t count, Interrupt& interrupt,
              std::int32_t* found) const;

 private:
    SpaceTriangulation tetrahedra_;
    SpaceScale scale_;
};

}  // namespace liftmesh
