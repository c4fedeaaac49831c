// The removal of vertices, the least significant first. What a removal would cost is computed from
// the samples of the star alone; it is computed again for the neighbours of a vertex that went.
#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "base/floating_point.hpp"
#include "simplification/grid.hpp"
#include "simplification/lists.hpp"
#include "simplification/simplify.hpp"

namespace liftmesh::simplification {

namespace {

constexpr std::size_t most_neighbors = 64;  // of a vertex that is considered: others stay
constexpr double infinity = std::numeric_limits<double>::infinity();

// The largest distance after the removal; none, if it exceeds the tolerance.
struct ByTolerance {
    void add_before(const Facet&, const Sample&) {}
    bool add_after(const Facet& facet, const Sample& sample) {
        const double distance = facet.distance(sample);
        if (facet.exceeds(sample, distance)) return false;
        cost = std::max(cost, distance);
        return true;
    }
    static constexpr bool needs_before = false;
    double cost = 0;
};

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
    static constexpr bool needs_before = true;
    double cost = 0;
};

struct Offer {
    double cost;
    Point point;
    Vertex vertex;
    std::uint32_t version;

    // The cheapest comes first, then the lexicographically least.
    bool operator<(const Offer& other) const {
        if (cost != other.cost) return cost > other.cost;
        return before_xy(other.point, point);
    }
};

template <class Samples, class Measure>
class Removal {
 public:
    Removal(Cover<Samples>& cover, std::size_t least, Interrupt& interrupt)
        : cover_(cover),
          least_(least),
          interrupt_(interrupt),
          version_(cover.mesh().vertex_end()) {}

    Status run();

 private:
    bool plan(Vertex v);
    double cost(Vertex v);
    void offer(Vertex v);
    void remove(Vertex v);

    Cover<Samples>& cover_;
    std::size_t least_;
    Interrupt& interrupt_;
    std::vector<std::uint32_t> version_;
    std::priority_queue<Offer> heap_;
    dynamic::Star star_;
    dynamic::Patch patch_;
    std::vector<Facet> facets_;
};

// The star and the patch of a vertex that may go.
template <class Samples, class Measure>
bool Removal<Samples, Measure>::plan(Vertex v) {
    if (cover_.is_corner(v)) return false;
    cover_.mesh().find_star(v, star_);
    if (star_.link.size() > most_neighbors) return false;
    cover_.mesh().plan(star_, patch_);
    facets_.resize(patch_.count());
    for (std::size_t i = 0; i < patch_.count(); ++i) {
        const Vertex* corners = &patch_.vertices[3 * i];
        if (corners[0] != ghost && corners[1] != ghost && corners[2] != ghost)
            facets_[i] = cover_.facet(corners);
    }
    return true;
}

template <class Samples, class Measure>
double Removal<Samples, Measure>::cost(Vertex v) {
    if (!plan(v)) return infinity;
    Measure measure;
    const bool is_allowed = cover_.each_after(
        v, star_, patch_,
        [&](std::size_t i, const Sample& s) { return measure.add_after(facets_[i], s); });
    if (!is_allowed) return infinity;
    if (!Measure::needs_before) return measure.cost;
    for (const TriangleId t : star_.triangles) {
        if (cover_.mesh().slots().is_ghost(t)) continue;
        const Facet before = cover_.facet(t);
        cover_.each_of(t, [&](std::uint32_t, const Sample& s) {
            measure.add_before(before, s);
            return true;
        });
    }
    return measure.cost;
}

template <class Samples, class Measure>
void Removal<Samples, Measure>::offer(Vertex v) {
    const double found = cost(v);
    if (found < infinity) heap_.push({found, cover_.mesh().point(v), v, version_[v]});
}

template <class Samples, class Measure>
void Removal<Samples, Measure>::remove(Vertex v) {
    plan(v);
    const std::vector<Vertex> neighbors = star_.link;
    cover_.remove(v, star_, patch_);
    ++version_[v];
    for (const Vertex each : neighbors) {
        if (each == ghost) continue;
        ++version_[each];
        offer(each);
    }
}

template <class Samples, class Measure>
Status Removal<Samples, Measure>::run() {
    Patience patience(interrupt_);
    for (Vertex v = 0; v < cover_.mesh().vertex_end(); ++v) {
        if (patience.ends(64)) return Status::interrupted;
        if (cover_.mesh().is_present(v)) offer(v);
    }
    while (!heap_.empty() && cover_.vertices() > least_) {
        const Offer next = heap_.top();
        heap_.pop();
        if (next.version != version_[next.vertex]) continue;
        if (patience.ends(256)) return Status::interrupted;
        remove(next.vertex);
        interrupt_.advance(1);
    }
    return Status::ok;
}

}  // namespace

template <class Samples>
Status prune(Cover<Samples>& cover, Interrupt& interrupt) {
    return Removal<Samples, ByTolerance>(cover, 0, interrupt).run();
}
template Status prune(Cover<Grid>&, Interrupt&);
template Status prune(Cover<Lists>&, Interrupt&);

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
    found.status = Removal<Lists, BySquares>(cover, most, interrupt).run();
    found.rows = cover.rows();
    return found;
}

}  // namespace liftmesh::simplification
