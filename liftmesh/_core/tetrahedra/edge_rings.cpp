#include "tetrahedra/edge_rings.hpp"

#include "sorting/patient_sort.hpp"

namespace liftmesh {

bool list_edge_rings(const std::int32_t* simplices, const std::int32_t* neighbors,
                     std::size_t count, Interrupt& interrupt, ListedRings& found) {
    EdgeRings edges(simplices, neighbors, count);
    std::vector<std::int32_t> cells;
    cells.reserve(6 * count);
    Patience patience(interrupt);
    const auto add = [&](const std::vector<AtEdge>& ring, bool is_open) {
        const AtEdge &begin = ring.front(), &end = ring.back();
        found.rings.push_back(
            {{edges.corner(begin.t, begin.tail), edges.corner(begin.t, begin.head)},
             {edges.corner(begin.t, begin.first()), edges.corner(end.t, end.last())},
             is_open,
             cells.size(),
             ring.size()});
        for (const AtEdge& at : ring) cells.push_back(at.t);
        patience.ends(ring.size());
    };
    for (std::size_t t = 0; t < count; ++t) {
        if (patience.ends()) return false;
        edges.visit(t, add);
    }
    const auto is_before = [](const ListedRing& a, const ListedRing& b) { return a.ends < b.ends; };
    if (!patient_sort(found.rings, is_before, interrupt)) return false;
    found.cells.resize(cells.size());
    std::size_t place = 0;
    for (ListedRing& ring : found.rings) {
        if (patience.ends(ring.count)) return false;
        std::copy_n(&cells[ring.first], ring.count, &found.cells[place]);
        ring.first = std::exchange(place, place + ring.count);
    }
    return true;
}

}  // namespace liftmesh
