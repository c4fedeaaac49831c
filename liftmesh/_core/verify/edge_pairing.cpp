// Two half-edges with the same ends and opposite directions are an edge between two triangles. In
// lists that keep neighbouring triangles close, as most programs write them, nearly every half-edge
// finds its twin while that is still in a small table (`PairingTable`), and the bounds of two
// cotangents decide nearly every edge (`TriangleBatch`). What is left over is mostly boundary, and
// alone in its slot (`Slots`); a hash partition by the ends brings together the rest: O(n log n)
// for any order.

#include "verify/edge_pairing.hpp"

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "verify/hash_partition.hpp"
#include "verify/pairing_table.hpp"
#include "verify/sides.hpp"
#include "verify/triangle_batch.hpp"

namespace liftmesh {

namespace {

// Whether the perturbation would flip an edge between a, b, c and the apex d beyond it, all four on
// one circle. The lexicographically largest is lifted most, so above the plane of the other three:
// the edge stays unless it ends there.
bool is_flipped_on_circle(Point tail, Point head, Point apex, Point beyond) {
    const Point end = before_xy(tail, head) ? head : tail;
    const Point opposite = before_xy(apex, beyond) ? beyond : apex;
    return before_xy(opposite, end);
}

// Checks edges for one task, and collects what it finds.
class Checker {
 public:
    explicit Checker(const MeshView& mesh) : mesh_(mesh) {}

    // Adds what is wrong with a triangle that does not surely turn counter-clockwise. Whether its
    // half-edges are to be paired: not if a corner is not finite.
    bool check_triangle(std::size_t triangle, int& turn) {
        const std::size_t first = 3 * triangle;
        const Point a = mesh_.point(first), b = mesh_.point(first + 1);
        const Point c = mesh_.point(first + 2);
        if (!mesh_.finite && !(is_finite(a) & is_finite(b) & is_finite(c))) {
            for (std::size_t place = first; place < first + 3; ++place)
                if (!is_finite(mesh_.point(place)))
                    triangles.add(Flaw::non_finite, {mesh_.callers_place(place), 0});
            return false;
        }
        turn = orient2d(a, b, c);
        if (turn <= 0) {
            turned.push_back(static_cast<std::uint32_t>(triangle));
            triangles.add(turn < 0 ? Flaw::clockwise : Flaw::degenerate,
                          {mesh_.callers_place(first) / 3, 0});
        }
        return true;
    }

    // Adds the edge if the apex of one triangle lies inside the circumcircle of the other. Edges of
    // clockwise and degenerate triangles are skipped.
    void check_edge(std::uint32_t one, std::uint32_t other) {
        const std::size_t first = one - one % 3;
        if (mesh_.sides != nullptr) return check_lifted(first, one, other);
        const Point a = mesh_.point(first), b = mesh_.point(first + 1);
        const Point c = mesh_.point(first + 2), d = mesh_.point(other);
        const InCircleFilter filter = incircle_filter(a, b, c, d);
        const double error = filter.error + mesh_.guard.margin();
        if (-filter.det > error) return;
        const int sign = filter.det > error ? 1 : incircle_exact(a, b, c, d, mesh_.guard);
        if (sign < 0 || (sign == 0 && !is_flipped_on_circle(one, d))) return;
        if (!is_counter_clockwise(first) || !is_counter_clockwise(other - other % 3)) return;
        flippable.push_back({one, other, sign > 0});
    }

    bool has_neighbors() const { return mesh_.neighbors != nullptr; }

    void join(std::uint32_t one, std::uint32_t other) {
        mesh_.neighbors[one] = static_cast<std::int32_t>(other / 3);
        mesh_.neighbors[other] = static_cast<std::int32_t>(one / 3);
    }

    // The same, soon: edges whose data are far apart are checked in batches, to prefetch them.
    void add_edge(std::uint32_t one, std::uint32_t other) {
        __builtin_prefetch(&mesh_.simplices[one]);
        __builtin_prefetch(&mesh_.simplices[other]);
        batch_[batch_size_++] = {one, other};
        if (batch_size_ == batch_.size()) check_batch();
    }

    void check_batch() {
        for (std::size_t i = 0; i < batch_size_; ++i) {
            prefetch(batch_[i].one - batch_[i].one % 3, 3);
            prefetch(batch_[i].other, 1);
        }
        for (std::size_t i = 0; i < batch_size_; ++i) check_edge(batch_[i].one, batch_[i].other);
        batch_size_ = 0;
    }

    std::size_t interior_edges = 0, covering = 0;
    std::vector<HalfEdge> unpaired;
    std::vector<FlippableEdge> flippable;
    std::vector<std::uint32_t> turned;
    Flaws triangles;

 private:
    struct Edge {
        std::uint32_t one, other;
    };

    void prefetch(std::size_t place, std::size_t count) const {
        for (const std::size_t end = place + count; place < end; ++place)
            __builtin_prefetch(&mesh_.points[mesh_.corner(place)]);
    }

    bool is_flipped_on_circle(std::uint32_t place, Point beyond) const {
        const HalfEdge edge = mesh_.half_edge(place / 3, static_cast<int>(place % 3));
        return liftmesh::is_flipped_on_circle(mesh_.points[edge.tail], mesh_.points[edge.head],
                                              mesh_.point(place), beyond);
    }

    // The same for another lift. Four lifts on one plane may be of points on a line, or within a
    // triangle.
    void check_lifted(std::size_t first, std::uint32_t one, std::uint32_t other) {
        const int sign = mesh_.sides->side(mesh_.corner(first), mesh_.corner(first + 1),
                                           mesh_.corner(first + 2), mesh_.corner(other));
        if (sign < 0) return;
        if (sign == 0 && perturbed_sign(mesh_.point(first), mesh_.point(first + 1),
                                        mesh_.point(first + 2), mesh_.point(other)) <= 0)
            return;
        if (!is_counter_clockwise(first) || !is_counter_clockwise(other - other % 3)) return;
        flippable.push_back({one, other, sign > 0});
    }

    bool is_counter_clockwise(std::size_t first) const {
        return orient2d(mesh_.point(first), mesh_.point(first + 1), mesh_.point(first + 2)) > 0;
    }

    const MeshView& mesh_;
    std::array<Edge, 64> batch_{};
    std::size_t batch_size_ = 0;
};

// Reads the triangles of one task in order, a batch at a time: first their corners, which are
// prefetched, then measures them, then pairs their half-edges.
class Reader {
 public:
    Reader(const MeshView& mesh, Checker& checker, std::size_t first, std::size_t last)
        : mesh_(mesh),
          checker_(checker),
          first_(first),
          last_(last),
          table_(3 * first),
          cotangents_(allocate<double>(3 * (last - first))) {}

    void run() {
        for (std::size_t t = first_; t < last_; t += TriangleBatch::size) {
            read_corners(t);
            checker_.covering += batch_.measure(mesh_.guard);
            doubtful_ = 0;
            for (std::size_t i = 0; i < std::min(TriangleBatch::size, last_ - t); ++i)
                pair_triangle(t + i, i);
            for (std::size_t i = 0; i < doubtful_; ++i)
                checker_.check_edge(edges_[i].one, edges_[i].other);
        }
        table_.for_each([&](const HalfEdge& edge) { checker_.unpaired.push_back(edge); });
    }

 private:
    struct Edge {
        std::uint32_t one, other;
    };
    static constexpr double infinity = std::numeric_limits<double>::infinity();

    void read_corners(std::size_t t) {
        if (t + TriangleBatch::size > last_) batch_ = {};
        const std::size_t count = std::min(TriangleBatch::size, last_ - t);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t later = 3 * std::min(t + i + TriangleBatch::size, last_ - 1);
            for (std::size_t place = later; place < later + 3; ++place)
                __builtin_prefetch(&mesh_.points[mesh_.corner(place)]);
            const std::size_t place = 3 * (t + i);
            batch_.set(i, mesh_.point(place), mesh_.point(place + 1), mesh_.point(place + 2));
        }
    }

    void pair_triangle(std::size_t triangle, std::size_t i) {
        double* const cotangents = &cotangents_[3 * (triangle - first_)];
        for (std::size_t k = 0; k < 3; ++k) cotangents[k] = batch_.cotangent(i, k);
        // They tell about circles: with another lift every edge is checked.
        if (mesh_.sides != nullptr) std::fill_n(cotangents, 3, -infinity);
        if (!batch_.is_certain(i)) {
            int turn = 0;
            const bool is_finite = checker_.check_triangle(triangle, turn);
            std::fill_n(cotangents, 3, turn > 0 ? -infinity : infinity);
            if (!is_finite) return;
        }
        for (int k = 0; k < 3; ++k) pair(mesh_.half_edge(triangle, k), cotangents[k]);
    }

    // Of a triangle that is not counter-clockwise no edge is judged: its bounds are infinity, and
    // where a sum with them is no number, `check_edge` leaves the edge out. An edge from a row to
    // itself is its own opposite, so the table would pair two of them.
    void pair(const HalfEdge& edge, double cotangent) {
        if (edge.tail == edge.head) {
            checker_.unpaired.push_back(edge);
            return;
        }
        std::uint32_t twin = 0;
        const auto evict = [&](const HalfEdge& oldest) { checker_.unpaired.push_back(oldest); };
        const bool paired = table_.pair(edge, twin, evict);
        const double sum = cotangent + cotangents_[twin - 3 * first_];
        checker_.interior_edges += paired;
        if (checker_.has_neighbors() && paired) checker_.join(edge.place, twin);
        edges_[doubtful_] = {edge.place, twin};
        doubtful_ += paired & !(sum > 0);
    }

    const MeshView& mesh_;
    Checker& checker_;
    std::size_t first_, last_;
    TriangleBatch batch_;
    PairingTable table_;
    Buffer<double> cotangents_;  // a lower bound for each corner that was read
    std::array<Edge, 3 * TriangleBatch::size + 1> edges_;
    std::size_t doubtful_ = 0;
};

// Half-edges with the same ends: [first, middle) run in one direction, [middle, last) in the other.
// If one direction has several, which of them are twins is undecidable, and the edge is not tested.
template <class It>
void pair_opposite(It first, It middle, It last, Checker& checker) {
    const auto pairs = std::min(middle - first, last - middle);
    checker.interior_edges += static_cast<std::size_t>(pairs);
    if (pairs == 1 && last - first == 2) {
        if (checker.has_neighbors()) checker.join(first->place, middle->place);
        checker.add_edge(first->place, middle->place);
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

// Moves half-edges that surely have no twin to the boundary.
bool set_apart_alone(ThreadPool& pool, std::vector<std::vector<HalfEdge>>& unpaired,
                     std::vector<HalfEdge>& boundary) {
    std::vector<std::vector<HalfEdge>> alone(unpaired.size());
    const auto add = [&](std::size_t i, const HalfEdge& edge) { alone[i].push_back(edge); };
    const bool done = keep_shared(unpaired, pool, EdgeHash(), add);
    for (const auto& edges : alone) boundary.insert(boundary.end(), edges.begin(), edges.end());
    return done;
}

bool pair_by_hash(const MeshView& mesh, ThreadPool& pool,
                  std::vector<std::vector<HalfEdge>>& unpaired, EdgePairing& pairing) {
    if (!set_apart_alone(pool, unpaired, pairing.boundary)) return false;
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
    if (mesh.neighbors != nullptr) std::fill_n(mesh.neighbors, 3 * mesh.count, -1);
    std::vector<std::vector<HalfEdge>> unpaired;
    const auto read = [&](std::size_t task, Checker& checker) {
        const std::size_t first = task * block, last = std::min(mesh.count, first + block);
        Reader(mesh, checker, first, last).run();
        pool.interrupt().advance(3 * (last - first));
    };
    return run_tasks(mesh, blocks(mesh.count), pool, pairing, unpaired, read) &&
           pair_by_hash(mesh, pool, unpaired, pairing);
}

}  // namespace liftmesh
