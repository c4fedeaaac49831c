#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "base/floating_point.hpp"
#include "simplification/simplify.hpp"

namespace liftmesh::simplification {

namespace {

// The worst sample of a triangle.
struct Candidate {
    double distance = -1;
    Point point{};
    std::uint32_t sample = none;
    TriangleId triangle = 0;

    // Whether the other one comes first: by distance, then by coordinates.
    bool operator<(const Candidate& other) const {
        if (distance != other.distance) return distance < other.distance;
        return before_xy(other.point, point);
    }
};

class Greedy {
 public:
    Greedy(Cover& cover, double tolerance, std::size_t most, Interrupt& interrupt)
        : cover_(cover), tolerance_(tolerance), most_(most), interrupt_(interrupt) {}

    Status run();
    bool is_done() const { return heap_.empty(); }

 private:
    static constexpr std::size_t whole = 1000;

    void consider(Candidate& worst, const Facet& facet, std::uint32_t s) const;
    void offer(const Candidate& worst);
    void insert(const Candidate& next);
    void tell(double distance);

    Cover& cover_;
    double tolerance_;
    std::size_t most_;
    Interrupt& interrupt_;
    std::priority_queue<Candidate> heap_;
    std::vector<std::uint32_t> worst_;  // of a slot
    std::vector<Facet> facets_;
    std::vector<Candidate> found_;
    double first_ = 0;
    std::size_t told_ = 0;
};

void Greedy::consider(Candidate& worst, const Facet& facet, std::uint32_t s) const {
    const Sample& sample = cover_.sample(s);
    double distance = facet.distance(sample);
    if (distance <= facet.surely_within()) return;
    if (std::isnan(distance)) distance = std::numeric_limits<double>::infinity();
    const Candidate found{distance, sample.point, s, worst.triangle};
    if (worst < found && facet.exceeds(sample, distance)) worst = found;
}

void Greedy::offer(const Candidate& worst) {
    const std::size_t slot = slot_of(worst.triangle);
    if (slot >= worst_.size()) worst_.resize(slot + 1, none);
    worst_[slot] = worst.sample;
    if (worst.sample != none) heap_.push(worst);
}

void Greedy::insert(const Candidate& next) {
    facets_.clear();
    found_.clear();
    // The facets of the star are known once it is there: at the first sample, or afterwards.
    cover_.insert(next.sample, next.triangle, [&](std::uint32_t s, std::size_t k) {
        while (facets_.size() <= k) {
            const TriangleId t = cover_.wedge(facets_.size());
            facets_.push_back(cover_.facet(t));
            found_.push_back({-1, {}, none, t});
        }
        consider(found_[k], facets_[k], s);
    });
    worst_.resize(slot_of(cover_.mesh().slots().end()), none);
    for (const TriangleId t : cover_.made()) worst_[slot_of(t)] = none;
    for (const Candidate& each : found_) offer(each);
}

// What is left of the logarithm of the distance, or of the vertices: whichever is further.
void Greedy::tell(double distance) {
    const double least = std::max(tolerance_, first_ * 1e-6);
    double done = std::log(first_ / distance) / std::log(first_ / least);
    if (most_ != 0) {
        const double part = static_cast<double>(cover_.vertices()) / static_cast<double>(most_);
        done = std::max(done, part);
    }
    if (!(done > 0)) return;
    const auto now = static_cast<std::size_t>(std::min(done, 1.0) * static_cast<double>(whole - 1));
    if (now > told_) interrupt_.advance(now - told_);
    told_ = std::max(told_, now);
}

Status Greedy::run() {
    interrupt_.expect(whole);
    if (!cover_.begin_with_corners(interrupt_)) return Status::interrupted;
    const dynamic::Slots& slots = cover_.mesh().slots();
    Patience patience(interrupt_);
    for (TriangleId t = 0; t < slots.end(); t += words_per_triangle) {
        if (slots.is_free(t) || slots.is_ghost(t)) continue;
        const Facet facet = cover_.facet(t);
        Candidate worst{-1, {}, none, t};
        cover_.each_of(t, [&](std::uint32_t s) { consider(worst, facet, s); });
        offer(worst);
        first_ = std::max(first_, worst.distance);
    }
    while (!heap_.empty() && (most_ == 0 || cover_.vertices() < most_)) {
        const Candidate next = heap_.top();
        heap_.pop();
        if (worst_[slot_of(next.triangle)] != next.sample) continue;
        insert(next);
        if (patience.ends(16)) return Status::interrupted;
        if (cover_.vertices() % 64 == 0) tell(next.distance);
    }
    while (!heap_.empty() && worst_[slot_of(heap_.top().triangle)] != heap_.top().sample)
        heap_.pop();
    return Status::ok;
}

}  // namespace

Simplified simplify(const Terrain& terrain, double tolerance, std::size_t most, bool prunes,
                    Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Cover cover(terrain, tolerance);
    Greedy greedy(cover, tolerance, most, interrupt);
    Simplified found;
    found.status = greedy.run();
    if (found.status != Status::ok) return found;
    found.is_within = greedy.is_done();
    found.inserted = cover.vertices();
    if (found.is_within && prunes) found.status = prune(cover, interrupt);
    found.rows = cover.rows();
    return found;
}

}  // namespace liftmesh::simplification
