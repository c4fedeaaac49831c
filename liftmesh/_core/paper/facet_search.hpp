// What Procedures 1 and 3 share: the points, the exact predicate where doubles are inconclusive,
// and the counts.
#pragma once

#include <cstdint>

#include "base/status.hpp"
#include "paper/counts.hpp"
#include "paper/points.hpp"

namespace liftmesh::paper {

template <class Points>
class FacetSearch {
 public:
    FacetSearch(const Points& points, Interrupt& interrupt) : p_(points), patience_(interrupt) {}

    const Counts& counts() const { return counts_; }
    bool interrupted() { return patience_.ends(0); }

 protected:
    // For inconclusive evaluations; it takes up to a hundred times as long as a dot product. a, b
    // and p_l are not candidates for p: they are on the plane, so only here need they be excluded.
    bool is_below(Vertex a, Vertex b, Vertex l, Vertex v) {
        if (v == a || v == b || v == l) return false;
        ++counts_.undecided;
        patience_.ends(64);
        return p_.is_below(a, b, l, v);
    }

    // How many of a, b and p_l are among the first `count` points: P \ {a, b, p_l} excludes them.
    static std::uint64_t members_of_plane(Vertex a, Vertex b, Vertex l, Vertex count) {
        return std::uint64_t{a < count} + (b < count) + (l < count);
    }

    const Points& p_;
    Patience patience_;
    Counts counts_;
};

}  // namespace liftmesh::paper
