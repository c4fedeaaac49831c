// Which sides belong together, which are the border, and whether those that belong together are
// Delaunay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"
#include "verify/subject.hpp"

namespace liftmesh {

struct Sides {
    Flaws triangles, edges;    // what is wrong with them
    std::size_t inner = 0;     // edges between two triangles
    std::vector<Side> border;  // sides without a partner
};

// Looks at each triangle, and pairs its sides with those of the triangles around it. All corners
// must be rows; triangles with corners that are not finite are left out. False where the interrupt
// came first.
bool pass_triangles(const Subject& subject, ThreadPool& pool, Sides& sides);

// Pairs all sides by sorting them, which names what is doubled.
bool sort_sides(const Subject& subject, ThreadPool& pool, Sides& sides);

}  // namespace liftmesh
