#include <cstdint>
#include <utility>

#include "base/floating_point.hpp"
#include "base/hash.hpp"
#include "simplification/lists.hpp"
#include "simplification/removal.hpp"
#include "simplification/simplify.hpp"
#include "sorting/sample.hpp"

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
    // Where vertices cost the same, as on level ground, they go in random order. In the order of
    // their coordinates the triangles behind the last one would become ever longer: each step would
    // look at as many samples as a row of a raster has.
    static bool is_first(Point p, Point q) {
        const std::uint64_t of_p = random_number(hash(p), 0), of_q = random_number(hash(q), 0);
        return of_p != of_q ? of_p < of_q : before_xy(p, q);
    }
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
    Cover cover(std::move(lists), corners_of(terrain), limit);
    found.status = cover.begin_with_all(interrupt);
    if (found.status != Status::ok) return found;
    Removal<Lists, BySquares> removal(cover, most, 1, interrupt);
    for (Vertex v = 0; v < cover.mesh().vertex_end(); ++v) removal.offer(v);
    found.status = removal.run();
    found.rows = cover.rows();
    return found;
}

}  // namespace liftmesh::simplification
