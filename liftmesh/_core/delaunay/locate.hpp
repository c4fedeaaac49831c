// Point location in a finished Delaunay triangulation, exact, for many queries at once.
//
// A kd tree over a sample of the vertices puts the queries into spatial order, and knows a triangle
// in each cell; a walk leads from one query to the next. A walk that would take long, as in a fan
// or among slivers, is left to a second index, which cuts along the edges themselves. It is made
// once long walks have taken as many steps as a quarter of the triangles: ordinary triangulations
// need the first index only. Answers depend on the point alone: not on the other queries, their
// order or the threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/status.hpp"
#include "delaunay/edge_tree.hpp"
#include "delaunay/hubs.hpp"
#include "delaunay/query_order.hpp"
#include "delaunay/triangulated.hpp"
#include "delaunay/walk.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/splitters.hpp"

namespace liftmesh {

class Locator {
 public:
    explicit Locator(const Triangulated& triangulated);
    ~Locator();
    Locator(const Locator&) = delete;
    Locator& operator=(const Locator&) = delete;

    // For each query the smallest simplex whose closed triangle contains it; -1 outside the hull,
    // and for points that are not finite. False if the interrupt came first. Several threads may
    // call it at once.
    bool find(const Queries& queries, std::int32_t* found, Threads threads, Interrupt& interrupt);

 private:
    class Round;

    // What leads to the queries that are hard to reach by walking.
    struct Index {
        EdgeTree edges;
        Hubs hubs;
    };
    const Index* index(Patience& patience);

    Triangulated mesh_;
    Splitters splitters_;
    std::vector<std::int32_t> start_;   // a simplex for each cell
    std::atomic<std::int64_t> credit_;  // steps that long walks may still take
    std::atomic<const Index*> index_ = nullptr;
};

}  // namespace liftmesh
