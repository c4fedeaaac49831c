// The last step of simplify: vertices go that the tolerance does not need. First those without
// which distances grow least, until each is needed. Then vertices and samples are exchanged
// (exchange.hpp), after which others may be vertices that are not needed: one round considers every
// vertex, and the worst sample of every triangle. Another follows, for those around which something
// has changed, as long as a round finds enough of them.

#include "simplification/exchange.hpp"
#include "simplification/grid.hpp"
#include "simplification/lists.hpp"
#include "simplification/removal.hpp"
#include "simplification/simplify.hpp"

namespace liftmesh::simplification {

namespace {

constexpr std::size_t enough = 20;  // another round follows if one vertex in so many went

// What each vertex was when it was considered last.
class Seen {
 public:
    bool is_new(Vertex v, std::uint32_t version) const {
        return v >= versions_.size() || versions_[v] != version;
    }
    void note(Vertex v, std::uint32_t version) {
        if (v >= versions_.size()) versions_.resize(v + std::size_t{1}, none);
        versions_[v] = version;
    }

 private:
    std::vector<std::uint32_t> versions_;
};

template <class Samples>
class Prune {
 public:
    Prune(Cover<Samples>& cover, Told& told, Interrupt& interrupt)
        : cover_(cover),
          told_(told),
          removal_(cover, 0, 0, interrupt),
          exchange_(cover, removal_) {}

    Status run();

 private:
    struct Lead {
        std::uint32_t sample;
        Vertex near;
    };

    Status remove();
    Status replace();
    Status add();
    void find_leads();
    bool is_new(TriangleId t) const;

    Cover<Samples>& cover_;
    Told& told_;
    Removal<Samples, ByTolerance> removal_;
    Exchange<Samples> exchange_;
    Seen replaced_, added_;
    std::vector<Lead> leads_;
};

template <class Samples>
Status Prune<Samples>::run() {
    Status status = remove();
    for (bool goes_on = true; goes_on && status == Status::ok;) {
        const std::size_t before = cover_.vertices();
        told_.begin(0.2);
        status = replace();
        if (status != Status::ok) break;
        told_.begin(0.5);
        status = add();
        goes_on = (before - cover_.vertices()) * enough >= before;
    }
    return status;
}

// In the order of their numbers, which is that of their insertion.
template <class Samples>
Status Prune<Samples>::remove() {
    const Vertex end = static_cast<Vertex>(cover_.mesh().vertex_end());
    for (Vertex v = 0; v < end; ++v) {
        if (removal_.ends(256)) return Status::interrupted;
        if (v % 64 == 0) told_.reach(static_cast<double>(v) / end);
        if (cover_.mesh().is_present(v)) removal_.offer(v);
    }
    return removal_.run();
}

template <class Samples>
Status Prune<Samples>::replace() {
    const Vertex end = static_cast<Vertex>(cover_.mesh().vertex_end());
    for (Vertex v = 0; v < end; ++v) {
        if (v % 64 == 0) told_.reach(static_cast<double>(v) / end);
        if (!cover_.mesh().is_present(v) || !replaced_.is_new(v, removal_.version(v))) continue;
        if (removal_.ends(256)) return Status::interrupted;
        replaced_.note(v, removal_.version(v));
        exchange_.replace(v);
    }
    return removal_.run();
}

template <class Samples>
bool Prune<Samples>::is_new(TriangleId t) const {
    const dynamic::Slots& slots = cover_.mesh().slots();
    for (unsigned k = 0; k < 3; ++k)
        if (added_.is_new(slots.vertex(t, k), removal_.version(slots.vertex(t, k)))) return true;
    return false;
}

template <class Samples>
void Prune<Samples>::find_leads() {
    const dynamic::Slots& slots = cover_.mesh().slots();
    leads_.clear();
    for (TriangleId t = 0; t < slots.end(); t += words_per_triangle) {
        if (removal_.ends(16)) return;
        if (slots.is_free(t) || slots.is_ghost(t) || !is_new(t)) continue;
        const std::uint32_t worst = exchange_.worst_of(t);
        if (worst != none) leads_.push_back({worst, slots.vertex(t, 0)});
    }
    for (Vertex v = 0; v < cover_.mesh().vertex_end(); ++v) added_.note(v, removal_.version(v));
}

template <class Samples>
Status Prune<Samples>::add() {
    find_leads();
    for (std::size_t i = 0; i < leads_.size(); ++i) {
        if (removal_.ends(256)) return Status::interrupted;
        if (i % 64 == 0) told_.reach(static_cast<double>(i) / static_cast<double>(leads_.size()));
        exchange_.add(leads_[i].sample, leads_[i].near);
    }
    return removal_.run();
}

}  // namespace

template <class Samples>
Status prune(Cover<Samples>& cover, Told& told, Interrupt& interrupt) {
    return Prune<Samples>(cover, told, interrupt).run();
}
template Status prune(Cover<Grid>&, Told&, Interrupt&);
template Status prune(Cover<Lists>&, Told&, Interrupt&);

}  // namespace liftmesh::simplification
