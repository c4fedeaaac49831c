// The removal of vertices, the least significant first. What a removal would cost is computed from
// the samples of the star alone, as a `Measure`; it is computed again for the neighbours of a
// vertex that went.
#pragma once

#include <queue>

#include "base/status.hpp"
#include "simplification/cover.hpp"

namespace liftmesh::simplification {

inline constexpr std::size_t most_neighbors = 64;  // of a vertex that is considered: others stay
inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct Offer {
    double cost;
    Point point;
    Vertex vertex;
    std::uint32_t version;
};

// The cheapest comes first; of equal ones, that whose point the measure puts first.
template <class Measure>
struct IsLater {
    bool operator()(const Offer& a, const Offer& b) const {
        return a.cost != b.cost ? a.cost > b.cost : Measure::is_first(b.point, a.point);
    }
};

template <class Samples, class Measure>
class Removal {
 public:
    // Calls `interrupt.advance(work)` for each vertex that goes.
    Removal(Cover<Samples>& cover, std::size_t least, std::size_t work, Interrupt& interrupt)
        : cover_(cover),
          least_(least),
          work_(work),
          interrupt_(interrupt),
          patience_(interrupt),
          version_(cover.mesh().vertex_end()) {}

    // Considers a vertex; one that may go waits for the others. None is if the run should end.
    void offer(Vertex v);
    // Removes those that wait, and then their neighbours, until none may go or few are left.
    Status run();

    // Counts steps, and samples that were visited; true if the run should end.
    bool ends(std::size_t steps) { return patience_.ends(steps + cover_.take_visits() / 8); }

    // The star and the patch of a vertex; false for those that never go.
    bool plan(Vertex v);
    // Those of a vertex that came after the others, however many neighbours it has.
    void plan_any(Vertex v);

    // No vertex, or one that stays for the time being.
    void hold(Vertex v) { held_ = v; }
    // The star of a vertex is another one now: what it would cost to remove it, too.
    void touch(Vertex v);
    // How often that was so.
    std::uint32_t version(Vertex v) const { return v < version_.size() ? version_[v] : 0; }

    const dynamic::Star& star() const { return star_; }
    const dynamic::Patch& patch() const { return patch_; }
    const Facet& facet(std::size_t i) const { return facets_[i]; }

 private:
    void plan_patch();
    double cost(Vertex v);
    void remove(Vertex v);

    Cover<Samples>& cover_;
    std::size_t least_, work_;
    Interrupt& interrupt_;
    Patience patience_;
    std::vector<std::uint32_t> version_;
    Vertex held_ = ghost;
    std::priority_queue<Offer, std::vector<Offer>, IsLater<Measure>> heap_;
    dynamic::Star star_;
    dynamic::Patch patch_;
    std::vector<Facet> facets_;
};

template <class Samples, class Measure>
bool Removal<Samples, Measure>::plan(Vertex v) {
    if (cover_.is_fixed(v)) return false;
    if (!cover_.mesh().find_star(v, most_neighbors, star_)) return false;
    plan_patch();
    return true;
}

template <class Samples, class Measure>
void Removal<Samples, Measure>::plan_any(Vertex v) {
    cover_.mesh().find_star(v, star_);
    plan_patch();
}

template <class Samples, class Measure>
void Removal<Samples, Measure>::plan_patch() {
    cover_.mesh().plan(star_, patch_);
    facets_.resize(patch_.count());
    for (std::size_t i = 0; i < patch_.count(); ++i) {
        const Vertex* corners = &patch_.vertices[3 * i];
        if (corners[0] != ghost && corners[1] != ghost && corners[2] != ghost)
            facets_[i] = cover_.facet(corners);
    }
}

template <class Samples, class Measure>
void Removal<Samples, Measure>::touch(Vertex v) {
    if (v >= version_.size()) version_.resize(cover_.mesh().vertex_end());
    ++version_[v];
}

template <class Samples, class Measure>
double Removal<Samples, Measure>::cost(Vertex v) {
    if (!plan(v)) return infinity;
    Measure measure;
    const auto add = [&](std::size_t i, std::uint32_t, const Sample& sample) {
        return measure.add_after(facets_[i], sample);
    };
    const bool is_allowed = cover_.each_after(v, star_, patch_, add);
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
    if (v >= version_.size()) version_.resize(cover_.mesh().vertex_end());
    if (v == held_ || ends(64)) return;
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
        touch(each);
        offer(each);
    }
}

template <class Samples, class Measure>
Status Removal<Samples, Measure>::run() {
    while (!heap_.empty() && cover_.vertices() > least_) {
        const Offer next = heap_.top();
        heap_.pop();
        if (next.version != version_[next.vertex]) continue;
        if (ends(256)) return Status::interrupted;
        remove(next.vertex);
        if (work_ != 0) interrupt_.advance(work_);
    }
    return ends(0) ? Status::interrupted : Status::ok;
}

}  // namespace liftmesh::simplification
