// Two half-edges with the same ends and opposite directions are an edge between two triangles. In
// lists that keep neighbouring triangles close, as most programs write them, nearly every half-edge
// finds its twin while that is still in a small table (`PairingTable`). A hash partition by the
// ends brings together what is left over: O(n log n) for any order.

#include "verify/edge_pairing.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "base/input.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/perturbation.hpp"
#include "verify/cover.hpp"
#include "verify/edge_groups.hpp"
#include "verify/hash_partition.hpp"
#include "verify/pairing_table.hpp"

namespace liftmesh {

namespace {

// Checks triangles and edges for one task, and collects what it finds.
class Checker {
 public:
    explicit Checker(const MeshView& mesh) : mesh_(mesh) {}

    // Whether the corners are finite; otherwise the half-edges are not paired.
    bool check_triangle(std::size_t triangle) {
        const std::size_t first = 3 * triangle;
        const Point a = mesh_.point(first), b = mesh_.point(first + 1);
        const Point c = mesh_.point(first + 2);
        if (!mesh_.finite && !(is_finite(a) & is_finite(b) & is_finite(c))) {
            for (std::size_t place = first; place < first + 3; ++place)
                if (!is_finite(mesh_.point(place)))
                    triangles.add(Flaw::non_finite, {mesh_.callers_place(place), 0});
            return false;
        }
        if (const int turn = orient2d(a, b, c); turn <= 0) {
            turned.push_back(static_cast<std::uint32_t>(triangle));
            triangles.add(turn < 0 ? Flaw::clockwise : Flaw::degenerate,
                          {mesh_.callers_place(first) / 3, 0});
        }
        covering += covers_upwards(a, b, c);
        return true;
    }

    // Adds an edge by the places of its two half-edges, the first in a triangle that was just read.
    // Edges are checked in batches, apart from the pairing that finds them, so that their data can
    // be prefetched.
    void add_edge(std::size_t triangle, std::uint32_t one, std::uint32_t other) {
        __builtin_prefetch(&mesh_.simplices[other]);
        batch_[batch_size_++] = {static_cast<std::uint32_t>(3 * triangle), one, other};
        if (batch_size_ == batch_.size()) check_batch();
    }

    // The same where neither triangle was.
    void add_distant_edge(std::uint32_t one, std::uint32_t other) {
        __builtin_prefetch(&mesh_.simplices[one]);
        distant_ = true;
        add_edge(one / 3, one, other);
    }

    void check_batch() {
        if (distant_)
            for (std::size_t i = 0; i < batch_size_; ++i) prefetch(batch_[i].first, 3);
        for (std::size_t i = 0; i < batch_size_; ++i) prefetch(batch_[i].other, 1);
        for (std::size_t i = 0; i < batch_size_; ++i) check_edge(batch_[i]);
        interior_edges += std::exchange(batch_size_, 0);
    }

    std::size_t interior_edges = 0, covering = 0;
    std::vector<HalfEdge> unpaired;
    std::vector<FlippableEdge> flippable;
    std::vector<std::uint32_t> turned;
    Flaws triangles;

 private:
    struct Edge {
        std::uint32_t first, one, other;  // the triangle of `one` begins at `first`
    };

    void prefetch(std::size_t place, std::size_t count) const {
        for (const std::size_t end = place + count; place < end; ++place)
            __builtin_prefetch(&mesh_.points[mesh_.corner(place)]);
    }

    // Adds the edge if the apex of one triangle lies inside the circumcircle of the other. Edges of
    // clockwise and degenerate triangles are skipped.
    void check_edge(Edge edge) {
        const auto [first, one, other] = edge;
        const Point a = mesh_.point(first), b = mesh_.point(first + 1);
        const Point c = mesh_.point(first + 2), d = mesh_.point(other);
        const InCircleFilter filter = incircle_filter(a, b, c, d);
        const double error = filter.error + mesh_.guard.margin();
        if (-filter.det > error) return;
        const int sign = filter.det > error ? 1 : incircle_exact(a, b, c, d, mesh_.guard);
        if (sign < 0 || (sign == 0 && perturbed_sign(a, b, c, d) <= 0)) return;
        if (!is_counter_clockwise(first) || !is_counter_clockwise(other - other % 3)) return;
        flippable.push_back({one, other, sign > 0});
    }

    bool is_counter_clockwise(std::size_t first) const {
        return orient2d(mesh_.point(first), mesh_.point(first + 1), mesh_.point(first + 2)) > 0;
    }

    const MeshView& mesh_;
    std::array<Edge, 64> batch_{};
    std::size_t batch_size_ = 0;
    bool distant_ = false;
};

// Reads the triangles of one task in order. Corners are prefetched.
class Reader {
 public:
    Reader(const MeshView& mesh, Checker& checker) : mesh_(mesh), checker_(checker) {}

    void run(std::size_t first, std::size_t last) {
        constexpr std::size_t ahead = 32;
        for (std::size_t t = first; t < last; ++t) {
            const std::size_t later = 3 * std::min(t + ahead, last - 1);
            for (std::size_t place = later; place < later + 3; ++place)
                __builtin_prefetch(&mesh_.points[mesh_.corner(place)]);
            read(t);
        }
        checker_.check_batch();
        table_.for_each([&](const HalfEdge& edge) { checker_.unpaired.push_back(edge); });
    }

 private:
    void read(std::size_t triangle) {
        if (!checker_.check_triangle(triangle)) return;
        for (int k = 0; k < 3; ++k) {
            const HalfEdge edge = mesh_.half_edge(triangle, k);
            if (edge.tail == edge.head) {  // its own opposite: the table would pair two of them
                checker_.unpaired.push_back(edge);
                continue;
            }
            std::uint32_t twin = 0;
            const auto evict = [&](const HalfEdge& oldest) { checker_.unpaired.push_back(oldest); };
            if (table_.pair(edge, twin, evict)) checker_.add_edge(triangle, edge.place, twin);
        }
    }

    const MeshView& mesh_;
    Checker& checker_;
    PairingTable table_;
};

// Half-edges with the same ends: [first, middle) run in one direction, [middle, last) in the other.
// If one direction has several, which of them are twins is undecidable, and the edge is not tested.
template <class It>
void pair_opposite(It first, It middle, It last, Checker& checker) {
    const auto pairs = std::min(middle - first, last - middle);
    if (std::max(middle - first, last - middle) > 1) {
        checker.interior_edges += static_cast<std::size_t>(pairs);
    } else if (pairs == 1) {
        checker.add_distant_edge(first->place, middle->place);
    }
    checker.unpaired.insert(checker.unpaired.end(), first + pairs, middle);
    checker.unpaired.insert(checker.unpaired.end(), middle + pairs, last);
}

// Runs work(task, checker) for each task, adds up what the checkers find, and collects what they
// leave unpaired.
template <class Work>
bool run_tasks(const MeshView& mesh, std::size_t tasks, ThreadPool& pool, EdgePairing& pairing,
               std::vector<std::vector<HalfEdge>>& unpaired, Work work) {
    std::vector<Checker> checkers(tasks, Checker(mesh));
    const bool done = pool.run(tasks, [&](std::size_t task) { work(task, checkers[task]); });
    unpaired.clear();
    for (Checker& checker : checkers) {
        pairing.interior_edges += checker.interior_edges;
        pairing.covering += checker.covering;
        pairing.triangles.add(checker.triangles);
        pairing.turned.insert(pairing.turned.end(), checker.turned.begin(), checker.turned.end());
        pairing.flippable.insert(pairing.flippable.end(), checker.flippable.begin(),
                                 checker.flippable.end());
        unpaired.push_back(std::move(checker.unpaired));
    }
    return done;
}

bool pair_by_hash(const MeshView& mesh, ThreadPool& pool,
                  std::vector<std::vector<HalfEdge>>& unpaired, EdgePairing& pairing) {
    const HashPartition<HalfEdge, EdgeHash> parts(unpaired, pool);
    if (!parts.complete()) return false;
    const auto pair_part = [&](std::size_t part, Checker& checker) {
        parts.for_each_bucket(part, [&](std::span<HalfEdge> edges) {
            for_each_edge(edges, [&](auto first, auto middle, auto last) {
                pair_opposite(first, middle, last, checker);
            });
        });
        checker.check_batch();
    };
    const bool done = run_tasks(mesh, parts.size(), pool, pairing, unpaired, pair_part);
    for (const std::vector<HalfEdge>& edges : unpaired)
        pairing.boundary.insert(pairing.boundary.end(), edges.begin(), edges.end());
    return done;
}

}  // namespace

bool pair_edges(const MeshView& mesh, ThreadPool& pool, EdgePairing& pairing) {
    std::vector<std::vector<HalfEdge>> unpaired;
    const auto read = [&](std::size_t task, Checker& checker) {
        const std::size_t first = task * block, last = std::min(mesh.count, first + block);
        Reader(mesh, checker).run(first, last);
        pool.interrupt().advance(3 * (last - first));
    };
    return run_tasks(mesh, blocks(mesh.count), pool, pairing, unpaired, read) &&
           pair_by_hash(mesh, pool, unpaired, pairing);
}

}  // namespace liftmesh
