// Few triangles within a bound, and the vertices that matter most.
#pragma once

#include "base/status.hpp"
#include "simplification/cover.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

struct Simplified {
    Status status = Status::ok;
    std::vector<Row> rows{};   // that stay
    bool is_within = false;    // whether no sample exceeds the tolerance
    std::size_t inserted = 0;  // vertices before those were removed that are not needed
};

// Greedy insertion (M. Garland and P. S. Heckbert, "Fast polygonal approximation of terrains and
// height fields", 1995): from the corners of the hull and the edges on, the sample with the largest
// distance becomes a vertex, until none exceeds the tolerance or there are so many vertices. Then,
// if asked for, vertices are removed again without which none does.
Simplified simplify(const Terrain& terrain, double tolerance, std::size_t most, bool prunes,
                    Interrupt& interrupt);

// Adaptive thinning (L. Demaret and A. Iske, "Adaptive image approximation by linear splines over
// locally optimal Delaunay triangulations", 2006): of all points, the one is removed next without
// which the sum of the squares of all distances grows least, until so many are left.
Simplified thin(const Terrain& terrain, std::size_t most, Interrupt& interrupt);

// How far a run is, in stages that are each a part of what is left.
class Told {
 public:
    explicit Told(Interrupt& interrupt) : interrupt_(interrupt) { interrupt.expect(whole); }
    void begin(double part) {
        reach(1);
        from_ = to_;
        to_ += (whole - from_) * part;
    }
    // So much of the stage is done.
    void reach(double share) {
        const auto now = static_cast<std::size_t>(from_ + (to_ - from_) * share);
        if (now > told_) interrupt_.advance(now - told_);
        told_ = std::max(told_, now);
    }

 private:
    static constexpr std::size_t whole = 1000;
    Interrupt& interrupt_;
    double from_ = 0, to_ = 0;
    std::size_t told_ = 0;
};

// The last step of simplify.
template <class Samples>
Status prune(Cover<Samples>& cover, Told& told, Interrupt& interrupt);

}  // namespace liftmesh::simplification
