// Point location in a finished Delaunay triangulation, exact, for many queries at once.
//
// A kd tree over a sample of the vertices puts the queries into spatial order, and knows a triangle
// in each cell; a walk leads from one query to the next. Ordinary triangulations need no more.
// Where walks are long, as in a fan or among slivers, two more parts help, each made when doing
// without it has cost about as much as making it: a trapezoidal map, by which a query takes O(log
// n) expected steps in every triangulation, and a table of the vertices of many triangles. Answers
// depend on the point alone: not on the other queries, their order, the parts or the threads.
#pragma once

#include "base/status.hpp"
#include "delaunay/first_containing.hpp"
#include "delaunay/made_on_demand.hpp"
#include "delaunay/query_order.hpp"
#include "delaunay/trapezoid_map.hpp"
#include "delaunay/triangulated.hpp"
#include "delaunay/walk.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/splitters.hpp"

namespace liftmesh {

// Called with the number of a query and its triangle, or -1, on whichever thread found it: soon
// after it was found, and after other queries near it.
using Settled = std::function<void(std::size_t, std::int32_t, Patience&)>;

class Locator {
 public:
    // The secret is that of the trapezoidal map. Answers do not depend on it.
    Locator(const Triangulated& triangulated, std::uint64_t secret);
    Locator(const Locator&) = delete;
    Locator& operator=(const Locator&) = delete;

    const Triangulated& mesh() const { return mesh_; }

    // For each query the smallest simplex whose closed triangle contains it; -1 outside the hull,
    // and for points that are not finite. False if the interrupt came first. Several threads may
    // call it at once. `settled` is called for each query, if it is given, mostly once.
    bool find(const Queries& queries, std::int32_t* found, Threads threads, Interrupt& interrupt,
              const Settled& settled = {});

 private:
    class Round;

    Triangulated mesh_;
    Splitters splitters_;
    std::vector<std::int32_t> start_;  // a simplex for each cell
    std::uint64_t secret_;
    MadeOnDemand<TrapezoidMap> map_;  // paid for by steps of long walks
    MadeOnDemand<Hubs> hubs_;         // paid for by steps around vertices
};

}  // namespace liftmesh
