// Half-edges that wait for their twin while triangles are read in an order that keeps neighbours
// close: a small table of sets of two. A third evicts the older of them, which the caller then
// pairs in another way.
//
// Whether the twin is present is unpredictable, so `pair` has no branch that depends on it.
#pragma once

#include "base/point.hpp"
#include "verify/flaws.hpp"

namespace liftmesh {

// Half-edges by their ends, in whatever direction they run.

inline std::uint64_t ends_of(const HalfEdge& edge) {
    const std::uint64_t low = std::min(edge.tail, edge.head);
    const std::uint64_t high = std::max(edge.tail, edge.head);
    return high << 32 | low;
}

struct EdgeHash {
    std::uint64_t operator()(const HalfEdge& edge) const { return hash(ends_of(edge)); }
};

// Calls visit(first, middle, last) for the half-edges with the same ends: [first, middle) run in
// one direction, [middle, last) in the other. Sorts them.
template <class Visit>
void for_each_edge(std::span<HalfEdge> edges, Visit visit) {
    const auto is_forward = [](const HalfEdge& edge) { return edge.tail < edge.head; };
    const auto before = [&](const HalfEdge& p, const HalfEdge& q) {
        return std::tuple(ends_of(p), is_forward(p), p.place) <
               std::tuple(ends_of(q), is_forward(q), q.place);
    };
    if (!std::is_sorted(edges.begin(), edges.end(), before))  // many may have the same ends
        std::sort(edges.begin(), edges.end(), before);
    for (auto first = edges.begin(); first != edges.end();) {
        const auto is_other = [&](const HalfEdge& edge) {
            return ends_of(edge) != ends_of(*first);
        };
        const auto last = std::find_if(first, edges.end(), is_other);
        visit(first, std::find_if(first, last, is_forward), last);
        first = last;
    }
}

class PairingTable {
 public:
    // No place is less than `first`.
    explicit PairingTable(std::size_t first = 0)
        : first_(static_cast<std::uint32_t>(first)), sets_(std::size_t{1} << set_bits) {}

    // Whether the twin of this half-edge is in the table. If so, its place is stored in `twin` and
    // it is removed; if not, this one is added, and evict(other) is called if that displaces
    // another. Then `twin` is any place that came before, or the first.
    template <class Evict>
    bool pair(const HalfEdge& edge, std::uint32_t& twin, Evict evict) {
        Set& set = sets_[EdgeHash()(edge) >> (64 - set_bits)];
        const std::uint64_t opposite = ends(edge.head, edge.tail);
        const bool in_0 = set.ends[0] == opposite, in_1 = set.ends[1] == opposite;
        const bool paired = in_0 | in_1;
        const std::size_t way = in_1 | (!in_0 & (set.age[1] < set.age[0]));
        const std::uint64_t all_if_paired = std::uint64_t{0} - paired;  // `empty`, or no bit
        const std::uint64_t displaced = set.ends[way] | all_if_paired;
        twin = set.age[way] + first_;
        if (displaced != empty) [[unlikely]]
            evict(half_edge(displaced, twin));
        set.ends[way] = ends(edge.tail, edge.head) | all_if_paired;
        set.age[way] = (edge.place - first_) & ~static_cast<std::uint32_t>(all_if_paired);
        return paired;
    }

    // Visits all that are left.
    template <class Visit>
    void for_each(Visit visit) const {
        for (const Set& set : sets_)
            for (const int way : {0, 1})
                if (set.ends[way] != empty) visit(half_edge(set.ends[way], set.age[way] + first_));
    }

 private:
    static constexpr int set_bits = 11;
    static constexpr std::uint64_t empty = ~std::uint64_t{0};

    // The places, counted from the first, ascend with time; that of an empty entry is 0.
    struct Set {
        std::uint64_t ends[2] = {empty, empty};
        std::uint32_t age[2] = {};
    };

    static std::uint64_t ends(Row tail, Row head) { return std::uint64_t{tail} << 32 | head; }

    static HalfEdge half_edge(std::uint64_t ends, std::uint32_t place) {
        return {static_cast<Row>(ends >> 32), static_cast<Row>(ends), place};
    }

    std::uint32_t first_;
    std::vector<Set> sets_;
};

}  // namespace liftmesh
