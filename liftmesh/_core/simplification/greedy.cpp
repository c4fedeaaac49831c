
#include "base/floating_point.hpp"
#include "simplification/grid.hpp"
#include "simplification/lists.hpp"
#include "simplification/simplify.hpp"

namespace liftmesh::simplification {

namespace {

// The worst sample of a triangle.
struct Candidate {
    double distance = -1;
    std::uint32_t sample = none;
    TriangleId triangle = 0;
};

template <class Samples>
class Greedy {
 public:
    Greedy(Cover<Samples>& cover, double tolerance, std::size_t most, Told& told,
           Interrupt& interrupt)
        : cover_(cover), tolerance_(tolerance), most_(most), told_(told), interrupt_(interrupt) {}

    Status run();
    bool is_done() const { return heap_.empty(); }

 private:
    // Whether the other one comes first: by distance, then at random.
    bool is_less(const Candidate& one, const Candidate& other) const {
        if (one.distance != other.distance) return one.distance < other.distance;
        return is_drawn_before(cover_.sample(other.sample).point, cover_.sample(one.sample).point);
    }
    Candidate worst_of(TriangleId t);
    Candidate pop();
    void offer(const Candidate& worst);
    void look_ahead() const;
    void insert(const Candidate& next);
    void tell(double distance);

    Cover<Samples>& cover_;
    double tolerance_;
    std::size_t most_;
    Told& told_;
    Interrupt& interrupt_;
    std::vector<Candidate> heap_;
    std::vector<std::uint32_t> worst_;  // of a slot
    double first_ = 0;
};

// Nearly all samples are nearer than the worst one so far, so little is done for these.
template <class Samples>
Candidate Greedy<Samples>::worst_of(TriangleId t) {
    if (!cover_.may_have_samples(t)) return {-1, none, t};
    const Facet facet = cover_.facet(t);
    Candidate worst{facet.surely_within(), none, t};
    cover_.each_of(t, [&](std::uint32_t s, const Sample& sample) {
        double distance = facet.distance(sample);
        if (distance < worst.distance) return true;
        if (std::isnan(distance)) distance = std::numeric_limits<double>::infinity();
        const Candidate found{distance, s, t};
        const bool is_worse =
            distance > worst.distance || (worst.sample != none && is_less(worst, found));
        if (is_worse && facet.exceeds(sample, distance)) worst = found;
        return true;
    });
    return worst;
}

template <class Samples>
void Greedy<Samples>::offer(const Candidate& worst) {
    const std::size_t slot = slot_of(worst.triangle);
    if (slot >= worst_.size()) worst_.resize(slot + 1, none);
    worst_[slot] = worst.sample;
    if (worst.sample == none) return;
    heap_.push_back(worst);
    std::push_heap(heap_.begin(), heap_.end(),
                   [this](const auto& a, const auto& b) { return is_less(a, b); });
}

template <class Samples>
Candidate Greedy<Samples>::pop() {
    std::pop_heap(heap_.begin(), heap_.end(),
                  [this](const auto& a, const auto& b) { return is_less(a, b); });
    const Candidate first = heap_.back();
    heap_.pop_back();
    return first;
}

// The first of the heap is nearly always the next one, and one of the following two comes after it.
template <class Samples>
void Greedy<Samples>::look_ahead() const {
    if (heap_.size() < 3) return;
    cover_.approach(heap_[0].triangle);
    for (const std::size_t i : {1, 2}) cover_.foresee(heap_[i].sample, heap_[i].triangle);
}

template <class Samples>
void Greedy<Samples>::insert(const Candidate& next) {
    cover_.insert(next.sample, next.triangle);
    const dynamic::Slots& slots = cover_.mesh().slots();
    worst_.resize(slot_of(slots.end()), none);
    for (const TriangleId t : cover_.mesh().star()) {
        worst_[slot_of(t)] = none;
        if (!slots.is_ghost(t)) offer(worst_of(t));
    }
}

// What is left of the logarithm of the distance, or of the vertices: whichever is further.
template <class Samples>
void Greedy<Samples>::tell(double distance) {
    const double least = std::max(tolerance_, first_ * 1e-6);
    double done = std::log(first_ / distance) / std::log(first_ / least);
    if (most_ != 0) {
        const double part = static_cast<double>(cover_.vertices()) / static_cast<double>(most_);
        done = std::max(done, part);
    }
    if (done > 0) told_.reach(std::min(done, 0.999));
}

template <class Samples>
Status Greedy<Samples>::run() {
    const Status begun = cover_.begin_with_skeleton(interrupt_);
    if (begun != Status::ok) return begun;
    const dynamic::Slots& slots = cover_.mesh().slots();
    Patience patience(interrupt_);
    for (TriangleId t = 0; t < slots.end(); t += words_per_triangle) {
        if (slots.is_free(t) || slots.is_ghost(t)) continue;
        const Candidate worst = worst_of(t);
        offer(worst);
        if (worst.sample != none) first_ = std::max(first_, worst.distance);
    }
    while (!heap_.empty() && (most_ == 0 || cover_.vertices() < most_)) {
        const Candidate next = pop();
        if (worst_[slot_of(next.triangle)] != next.sample) continue;
        look_ahead();
        insert(next);
        if (patience.ends(16 + cover_.take_visits() / 8)) return Status::interrupted;
        if (cover_.vertices() % 64 == 0) tell(next.distance);
    }
    while (!heap_.empty() && worst_[slot_of(heap_.front().triangle)] != heap_.front().sample) pop();
    return Status::ok;
}

template <class Samples>
Simplified simplify(Samples samples, const Terrain& terrain, double tolerance, std::size_t most,
                    bool prunes, Interrupt& interrupt) {
    const Tolerance limit(terrain, samples.turns(), tolerance);
    Cover cover(std::move(samples), skeleton_of(terrain), limit);
    Told told(interrupt);
    told.begin(prunes ? 0.3 : 1);
    Greedy greedy(cover, tolerance, most, told, interrupt);
    Simplified found;
    found.status = greedy.run();
    if (found.status != Status::ok) return found;
    found.is_within = greedy.is_done();
    found.inserted = cover.vertices();
    if (found.is_within && prunes) {
        told.begin(0.2);
        found.status = prune(cover, told, interrupt);
    }
    found.rows = cover.rows();
    return found;
}

}  // namespace

Simplified simplify(const Terrain& terrain, double tolerance, std::size_t most, bool prunes,
                    Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    if (std::optional<Grid> grid = Grid::of(terrain))
        return simplify(std::move(*grid), terrain, tolerance, most, prunes, interrupt);
    Lists lists(terrain);
    if (!lists.fill(terrain, interrupt)) return {Status::interrupted};
    return simplify(std::move(lists), terrain, tolerance, most, prunes, interrupt);
}

}  // namespace liftmesh::simplification
