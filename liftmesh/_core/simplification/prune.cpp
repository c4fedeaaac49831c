// The last step of simplify: vertices go that the tolerance does not need. First those without
// which distances grow least, until each is needed. Then each is exchanged, if the tolerance
// permits, for the worst of the other samples that its removal leaves; after that a neighbour may
// be one that is not needed. This is repeated as long as a round finds enough of them.
#include <algorithm>
#include <vector>

#include "simplification/grid.hpp"
#include "simplification/lists.hpp"
#include "simplification/removal.hpp"
#include "simplification/simplify.hpp"

namespace liftmesh::simplification {

namespace {

constexpr std::size_t enough = 50;  // another round follows if one vertex in so many went

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

template <class Samples>
class Prune {
 public:
    Prune(Cover<Samples>& cover, Told& told, Interrupt& interrupt)
        : cover_(cover), told_(told), removal_(cover, 0, 0, interrupt) {}

    Status run();

 private:
    // What a vertex may be exchanged for, and the triangle of the patch in which it is.
    struct Substitute {
        double distance = 0;
        std::uint32_t sample = none;
        std::size_t place = 0;
    };

    template <class Step>
    Status each_vertex(Step step);
    Substitute substitute(Vertex v);
    void exchange(Vertex v);
    bool is_within(TriangleId t);
    bool is_within_around();
    void offer_around(const std::vector<Vertex>& link);
    void put_back(std::uint32_t inserted, std::uint32_t removed, Vertex near);

    Cover<Samples>& cover_;
    Told& told_;
    Removal<Samples, ByTolerance> removal_;
    std::vector<TriangleId> filled_;
};

// In the order of their numbers, which is that of their insertion; then removes those that may go.
template <class Samples>
template <class Step>
Status Prune<Samples>::each_vertex(Step step) {
    const Vertex end = cover_.mesh().vertex_end();
    for (Vertex v = 0; v < end; ++v) {
        if (removal_.ends(256)) return Status::interrupted;
        if (v % 64 == 0) told_.reach(static_cast<double>(v) / end);
        if (cover_.mesh().is_present(v)) step(v);
    }
    return removal_.run();
}

template <class Samples>
Status Prune<Samples>::run() {
    Status status = each_vertex([&](Vertex v) { removal_.offer(v); });
    for (bool goes_on = true; goes_on && status == Status::ok;) {
        const std::size_t before = cover_.vertices();
        told_.begin(0.5);
        status = each_vertex([&](Vertex v) { exchange(v); });
        goes_on = (before - cover_.vertices()) * enough >= before;
    }
    return status;
}

// The worst sample of the patch, of several the lexicographically least. There is none if all
// others are on its planes.
template <class Samples>
auto Prune<Samples>::substitute(Vertex v) -> Substitute {
    Substitute worst;
    const auto consider = [&](std::size_t i, std::uint32_t s, const Sample& sample) {
        const Facet& facet = removal_.facet(i);
        const double distance = facet.distance(sample);
        if (distance < worst.distance || s == cover_.number(v)) return true;
        if (facet.is_corner(sample.point)) return true;
        const bool is_tie = distance == worst.distance && worst.sample != none;
        if (distance > worst.distance || (is_tie && cover_.is_before(s, worst.sample)))
            worst = {distance, s, i};
        return true;
    };
    cover_.each_after(v, removal_.star(), removal_.patch(), consider);
    return worst;
}

template <class Samples>
void Prune<Samples>::exchange(Vertex v) {
    if (!removal_.plan(v)) return;
    const Substitute other = substitute(v);
    if (other.sample == none) return;
    const std::vector<Vertex> link = removal_.star().link;
    const std::uint32_t removed = cover_.number(v);
    cover_.remove(v, removal_.star(), removal_.patch());
    filled_ = cover_.filled();
    cover_.insert(other.sample, filled_[other.place]);
    if (is_within_around()) return offer_around(link);
    put_back(other.sample, removed, link[link[0] == ghost ? 1 : 0]);
}

template <class Samples>
bool Prune<Samples>::is_within(TriangleId t) {
    const dynamic::Slots& slots = cover_.mesh().slots();
    if (slots.is_free(t) || slots.is_ghost(t) || !cover_.may_have_samples(t)) return true;
    const Facet facet = cover_.facet(t);
    return cover_.each_of(t, [&](std::uint32_t, const Sample& sample) {
        return !facet.exceeds(sample, facet.distance(sample));
    });
}

// What an exchange has made: the star of the vertex that came, and what is left of the patch.
template <class Samples>
bool Prune<Samples>::is_within_around() {
    const auto holds = [this](TriangleId t) { return is_within(t); };
    const std::vector<TriangleId>& star = cover_.mesh().star();
    return std::all_of(star.begin(), star.end(), holds) &&
           std::all_of(filled_.begin(), filled_.end(), holds);
}

// The neighbours of the vertex that went and of the one that came.
template <class Samples>
void Prune<Samples>::offer_around(const std::vector<Vertex>& link) {
    for (const Vertex v : link)
        if (v != ghost) removal_.offer(v);
    for (const dynamic::BorderEdge& each : cover_.mesh().border()) {
        const bool is_new = std::find(link.begin(), link.end(), each.tail) == link.end();
        if (is_new && each.tail != ghost) removal_.offer(each.tail);
    }
    removal_.run();
}

// The triangulation is again what it was, as it depends on the vertices alone.
template <class Samples>
void Prune<Samples>::put_back(std::uint32_t inserted, std::uint32_t removed, Vertex near) {
    const Vertex v = cover_.mesh().find(cover_.sample(inserted).point, near);
    removal_.plan(v);
    cover_.remove(v, removal_.star(), removal_.patch());
    const Point p = cover_.sample(removed).point;
    cover_.insert(removed, cover_.mesh().locate(p, near).triangle);
}

}  // namespace

template <class Samples>
Status prune(Cover<Samples>& cover, Told& told, Interrupt& interrupt) {
    return Prune<Samples>(cover, told, interrupt).run();
}
template Status prune(Cover<Grid>&, Told&, Interrupt&);
template Status prune(Cover<Lists>&, Told&, Interrupt&);

}  // namespace liftmesh::simplification
