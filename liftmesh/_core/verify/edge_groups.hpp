// Half-edges by their ends, in whatever direction they run.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>

#include "base/hash.hpp"
#include "verify/mesh_view.hpp"

namespace liftmesh {

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

}  // namespace liftmesh
