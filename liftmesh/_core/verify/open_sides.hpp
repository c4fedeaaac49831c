// The sides that wait for their partner, while triangles that lie near one another pass by: a small
// set-associative table. What waits too long has to leave; who asks then pairs it otherwise.
//
// Whether a partner is there is a coin toss, so a meeting has no jump that depends on it.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "verify/subject.hpp"

namespace liftmesh {

struct HashOfEdge {
    std::uint64_t operator()(const Side& side) const {
        const std::uint64_t low = std::min(side.tail, side.head);
        const std::uint64_t high = std::max(side.tail, side.head);
        return (high << 32 | low) * 0x9e3779b97f4a7c15u;
    }
};

class OpenSides {
 public:
    OpenSides() : sets_(std::size_t{1} << set_bits) {}

    // Whether a side that runs back along this one waits here. If so, its place goes to `partner`,
    // and it waits no more; if not, this one waits, and leaves(other) is called where another has
    // to leave for it.
    template <class Leaves>
    bool meet(const Side& side, std::uint32_t& partner, Leaves leaves) {
        Set& set = sets_[HashOfEdge()(side) >> (64 - set_bits)];
        const unsigned back = ways_with(set, ends(side.head, side.tail));
        const unsigned free = ways_with(set, nothing);
        const bool met = back != 0;
        int way = std::countr_zero((met ? back : free) | 1u << (ways - 1));
        if ((back | free) == 0) leaves(waiting(set, way = longest_waiting(set)));
        partner = set.place[way];
        set.ends[way] = met ? nothing : ends(side.tail, side.head);
        set.place[way] = side.place;
        return met;
    }

    // All that are still there.
    template <class Leaves>
    void for_each(Leaves leaves) const {
        for (const Set& set : sets_)
            for (int way = 0; way < ways; ++way)
                if (set.ends[way] != nothing) leaves(waiting(set, way));
    }

 private:
    static constexpr int set_bits = 11, ways = 4;
    static constexpr std::uint64_t nothing = ~std::uint64_t{0};

    struct Set {
        std::uint64_t ends[ways] = {nothing, nothing, nothing, nothing};
        std::uint32_t place[ways] = {};
    };

    static std::uint64_t ends(Row tail, Row head) { return std::uint64_t{tail} << 32 | head; }

    static unsigned ways_with(const Set& set, std::uint64_t value) {
        unsigned found = 0;
        for (int way = 0; way < ways; ++way) found |= unsigned{set.ends[way] == value} << way;
        return found;
    }

    // Places are met in ascending order.
    static int longest_waiting(const Set& set) {
        return static_cast<int>(std::min_element(set.place, set.place + ways) - set.place);
    }

    static Side waiting(const Set& set, int way) {
        return {static_cast<Row>(set.ends[way] >> 32), static_cast<Row>(set.ends[way]),
                set.place[way]};
    }

    std::vector<Set> sets_;
};

}  // namespace liftmesh
