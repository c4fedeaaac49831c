
#include "base/floating_point.hpp"
#include "simplification/lists.hpp"
#include "simplification/removal.hpp"
#include "simplification/simplify.hpp"

namespace liftmesh::simplification {

namespace {

// By how much the sum of the squares grows.
struct BySquares {
    void add_before(const Facet& facet, const Sample& sample) {
        const double distance = facet.distance(sample);
        cost -= distance * distance;
    }
    bool add_after(const Facet& facet, const Sample& sample) {
        const double distance = facet.distance(sample);
        cost += distance * distance;
        return true;
    }
    static bool is_first(Point p, Point q) { return is_drawn_before(p, q); }
    static constexpr bool needs_before = true;
    double cost = 0;
};

}  // namespace

Simplified thin(const Terrain& terrain, std::size_t most, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Simplified found;
    found.inserted = terrain.count;
    interrupt.expect(terrain.count > most ? terrain.count - most : 1);
    Lists lists(terrain);
    if (!lists.fill(terrain, interrupt)) return {Status::interrupted};
    const Tolerance limit(terrain, lists.turns(), 0);
    Cover cover(std::move(lists), skeleton_of(terrain), limit);
    found.status = cover.begin_with_all(interrupt);
    if (found.status != Status::ok) return found;
    Removal<Lists, BySquares> removal(cover, most, 1, interrupt);
    for (Vertex v = 0; v < cover.mesh().vertex_end(); ++v) removal.offer(v);
    found.status = removal.run();
    found.rows = cover.rows();
    return found;
}

}  // namespace liftmesh::simplification
