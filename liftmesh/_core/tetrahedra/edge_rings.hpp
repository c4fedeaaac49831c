// The tetrahedra around the edges of a triangulation of a convex region, in their order.
#pragma once

#include "base/status.hpp"

namespace liftmesh {

// A tetrahedron at an edge: the places of the ends in it, the lesser row first. The other corners
// follow in positive order, so from the first to the last it is counter-clockwise seen from the
// head. The next tetrahedron is across the facet opposite the first.
struct AtEdge {
    std::int32_t t;
    unsigned tail, head;

    unsigned first() const { return others[tail][head][0]; }
    unsigned last() const { return others[tail][head][1]; }

 private:
    static constexpr unsigned others[4][4][2] = {{{}, {2, 3}, {3, 1}, {1, 2}},
                                                 {{3, 2}, {}, {0, 3}, {2, 0}},
                                                 {{1, 3}, {3, 0}, {}, {0, 1}},
                                                 {{2, 1}, {0, 2}, {1, 0}, {}}};
};

// Each edge is walked around once, however many tetrahedra it has.
class EdgeRings {
 public:
    // Of `count` tetrahedra, and their neighbours, -1 beyond the hull.
    EdgeRings(const std::int32_t* simplices, const std::int32_t* neighbors, std::size_t count)
        : simplices_(simplices), neighbors_(neighbors), is_done_(count) {}

    // Calls visit(ring, is_open) for the edges of a tetrahedron that none visited before has: those
    // of the hull are open, the other rings begin here.
    template <class Visit>
    void visit(std::size_t t, Visit visit) {
        const auto name = static_cast<std::int32_t>(t);
        for (unsigned j = 1; j < 4; ++j) {
            for (unsigned i = 0; i < j; ++i) {
                if ((is_done_[t] & bit(i, j)) != 0) continue;
                const bool is_open = find(corner(name, i) < corner(name, j) ? AtEdge{name, i, j}
                                                                            : AtEdge{name, j, i});
                visit(std::as_const(ring_), is_open);
            }
        }
    }

    std::int32_t corner(std::int32_t t, unsigned i) const { return simplices_[place(t, i)]; }

 private:
    static std::size_t place(std::int32_t t, unsigned i) {
        return 4 * static_cast<std::size_t>(t) + i;
    }
    static std::uint16_t bit(unsigned i, unsigned j) {
        return static_cast<std::uint16_t>(1u << (4 * std::min(i, j) + std::max(i, j)));
    }
    unsigned place_of(std::int32_t row, std::int32_t t) const {
        unsigned i = 0;
        while (i < 3 && corner(t, i) != row) ++i;
        return i;
    }

    void take(const AtEdge& at) {
        auto& done = is_done_[static_cast<std::size_t>(at.t)];
        done = static_cast<std::uint16_t>(done | bit(at.tail, at.head));
        ring_.push_back(at);
    }
    // Across a facet; false beyond the hull.
    bool cross(AtEdge& at, unsigned k) const {
        const std::int32_t t = neighbors_[place(at.t, k)];
        if (t < 0) return false;
        at = {t, place_of(corner(at.t, at.tail), t), place_of(corner(at.t, at.head), t)};
        return true;
    }

    // Whether it is open.
    bool find(const AtEdge& start) {
        ring_.clear();
        take(start);
        AtEdge at = start;
        while (cross(at, at.first())) {
            if (at.t == start.t) return false;
            take(at);
        }
        const auto forward = static_cast<std::ptrdiff_t>(ring_.size());
        for (at = start; cross(at, at.last());) take(at);
        std::reverse(ring_.begin() + forward, ring_.end());
        std::rotate(ring_.begin(), ring_.begin() + forward, ring_.end());
        return true;
    }

    const std::int32_t *simplices_, *neighbors_;
    std::vector<std::uint16_t> is_done_;  // of each tetrahedron, a bit for each edge
    std::vector<AtEdge> ring_;
};

// All edges, as the dual diagram needs them, by their ends.
struct ListedRing {
    std::array<std::int32_t, 2> ends;
    // Beside the edge on the facets of the hull before the first tetrahedron and behind the last;
    // of a closed ring, on the facet where it begins.
    std::array<std::int32_t, 2> beside;
    bool is_open;
    std::size_t first, count;  // among the cells
};
struct ListedRings {
    std::vector<ListedRing> rings;
    std::vector<std::int32_t> cells;  // closed rings begin with their least
};

// False if the interrupt came first.
bool list_edge_rings(const std::int32_t* simplices, const std::int32_t* neighbors,
                     std::size_t count, Interrupt& interrupt, ListedRings& found);

}  // namespace liftmesh
