// The ghosts along the hull, in its order.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "delaunay/mesh.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// A part of the hull, and how many ghosts stand before it.
struct Stretch {
    std::span<const TriangleId> ghosts;
    std::size_t place;
};

class Ghosts {
 public:
    // Finds them: `any` is one, and `slots` the number of all triangles. Marks some of them in the
    // mesh while it runs. False if the interrupt came first.
    bool find(Mesh& mesh, std::size_t slots, TriangleId any, ThreadPool& pool);

    std::size_t count() const { return count_; }

    // Counter-clockwise from the hull edge that begins at the lexicographically least point. What
    // is done for each stretch can be done by any thread.
    const std::vector<Stretch>& stretches() const { return stretches_; }

 private:
    struct Walk {
        std::vector<TriangleId> ghosts;
        std::size_t least = 0;  // the place of the one whose tail is the least point
        std::size_t next = 0;   // the number of the walk that began where this one ended
    };

    void begin_at(Mesh& mesh, TriangleId g);
    void begin_at_some(Mesh& mesh, std::size_t slots, std::size_t tries);
    void unite(const Mesh& mesh);
    void add(std::span<const TriangleId> ghosts);

    std::vector<Walk> walks_;
    std::vector<Stretch> stretches_;
    std::size_t count_ = 0;
};

}  // namespace liftmesh
