// Few triangles within a bound, and the vertices that matter most.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/status.hpp"
#include "simplification/cover.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

struct Simplified {
    Status status = Status::ok;
    std::vector<Row> rows;     // that stay
    bool is_within = false;    // whether no sample exceeds the tolerance
    std::size_t inserted = 0;  // vertices before those were removed that are not needed
};

// Greedy insertion (M. Garland and P. S. Heckbert, "Fast polygonal approximation of terrains and
// height fields", 1995): from the corners of the hull on, the sample with the largest distance
// becomes a vertex, until none exceeds the tolerance or there are so many vertices. Then, if asked
// for, vertices are removed again without which none does.
Simplified simplify(const Terrain& terrain, double tolerance, std::size_t most, bool prunes,
                    Interrupt& interrupt);

// Adaptive thinning (L. Demaret and A. Iske, "Adaptive image approximation by linear splines over
// locally optimal Delaunay triangulations", 2006): of all points, the one is removed next without
// which the sum of the squares of all distances grows least, until so many are left.
Simplified thin(const Terrain& terrain, std::size_t most, Interrupt& interrupt);

// How far a run is, in stages of the same length.
class Told {
 public:
    Told(std::size_t stages, Interrupt& interrupt) : interrupt_(interrupt) {
        interrupt.expect(stages * whole);
    }
    // Begins the next stage.
    void begin() {
        reach(1);
        told_ = 0;
    }
    // A part of a stage is done.
    void reach(double part) {
        const auto now = static_cast<std::size_t>(part * static_cast<double>(whole));
        if (now > told_) interrupt_.advance(now - told_);
        told_ = std::max(told_, now);
    }

 private:
    static constexpr std::size_t whole = 1000;
    Interrupt& interrupt_;
    std::size_t told_ = 0;
};

// The last step of simplify.
template <class Samples>
Status prune(Cover<Samples>& cover, Told& told, Interrupt& interrupt);

}  // namespace liftmesh::simplification
