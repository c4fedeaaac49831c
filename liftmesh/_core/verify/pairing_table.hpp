// Half-edges that wait for their twin while triangles are read in an order that keeps neighbours
// close: a small set-associative table. A full set evicts its oldest entry, which the caller then
// pairs in another way.
//
// Whether the twin is present is unpredictable, so `pair` has no branch that depends on it.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "verify/edge_groups.hpp"
#include "verify/mesh_view.hpp"

namespace liftmesh {

class PairingTable {
 public:
    PairingTable() : sets_(std::size_t{1} << set_bits) {}

    // Whether the twin of this half-edge is in the table. If so, its place is stored in `twin` and
    // it is removed; if not, this one is added, and evict(other) is called if that displaces
    // another.
    template <class Evict>
    bool pair(const HalfEdge& edge, std::uint32_t& twin, Evict evict) {
        Set& set = sets_[EdgeHash()(edge) >> (64 - set_bits)];
        const unsigned opposite = ways_with(set, ends(edge.head, edge.tail));
        const unsigned free = ways_with(set, empty);
        const bool paired = opposite != 0;
        int way = std::countr_zero((paired ? opposite : free) | 1u << (ways - 1));
        if ((opposite | free) == 0) evict(entry(set, way = oldest(set)));
        twin = set.place[way];
        set.ends[way] = paired ? empty : ends(edge.tail, edge.head);
        set.place[way] = edge.place;
        return paired;
    }

    // Visits all that are left.
    template <class Visit>
    void for_each(Visit visit) const {
        for (const Set& set : sets_)
            for (int way = 0; way < ways; ++way)
                if (set.ends[way] != empty) visit(entry(set, way));
    }

 private:
    static constexpr int set_bits = 11, ways = 4;
    static constexpr std::uint64_t empty = ~std::uint64_t{0};

    struct Set {
        std::uint64_t ends[ways] = {empty, empty, empty, empty};
        std::uint32_t place[ways] = {};
    };

    static std::uint64_t ends(Row tail, Row head) { return std::uint64_t{tail} << 32 | head; }

    static unsigned ways_with(const Set& set, std::uint64_t value) {
        unsigned found = 0;
        for (int way = 0; way < ways; ++way) found |= unsigned{set.ends[way] == value} << way;
        return found;
    }

    // Half-edges arrive in ascending order of place.
    static int oldest(const Set& set) {
        return static_cast<int>(std::min_element(set.place, set.place + ways) - set.place);
    }

    static HalfEdge entry(const Set& set, int way) {
        return {static_cast<Row>(set.ends[way] >> 32), static_cast<Row>(set.ends[way]),
                set.place[way]};
    }

    std::vector<Set> sets_;
};

}  // namespace liftmesh
