// Most vertices of a mesh with a flaw are innocent, and no edge at such a vertex has two triangles
// on one side.
//
// Go once around a vertex and count the triangles at it that cover the direction. The count changes
// only across the edges at the vertex, and a pair of half-edges does not change it. So if all
// half-edges at the vertex are paired, and all triangles at it turn counter-clockwise, the count is
// the same in every direction, and at least 1. If it is 1 upwards, no two triangles at the vertex
// overlap, as two on the same side of an edge would.
//
// Nearly always one sum tells for all vertices at once: that of their counts is their number only
// if each is 1. If it is greater, the vertices with more are found one by one.
//
// Edges between vertices that are not innocent are suspects. A hash partition brings together those
// with the same ends: O(n log n) if all are.

#include "base/point.hpp"
#include "parallel/blocks.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/hash_partition.hpp"
#include "verify/pairing_table.hpp"

namespace liftmesh {

namespace {

// Which triangle at a vertex covers the direction upwards.
//
// Upwards means up and, to decide ties, a little to the left: the vertices that come later by x,
// then y, are on the right. So a counter-clockwise triangle covers that direction at its corner b
// where a, b, c is ascending, if it has such a corner.

constexpr int no_corner = 3;

// The corner at which the triangle a, b, c covers the direction, or `no_corner`.
int covering_corner(Point a, Point b, Point c) {
    const auto before = [](Point p, Point q) {  // as `before_xy`, without a branch
        return int{p.x < q.x} | (int{p.x == q.x} & int{p.y < q.y});
    };
    constexpr int corner[] = {no_corner, no_corner, no_corner, 1, no_corner, 0, 2, no_corner};
    return corner[before(a, b) | before(b, c) << 1 | before(c, a) << 2];
}

// Which rows are suspect.
class Suspects {
 public:
    Suspects(const MeshView& mesh, const EdgePairing& pairing) : mesh_(mesh), marks_(mesh.rows) {
        for (const HalfEdge& edge : pairing.boundary)
            marks_[edge.tail] = marks_[edge.head] = suspect;
        for (const std::size_t triangle : pairing.turned)
            for (std::size_t place = 3 * triangle; place < 3 * triangle + 3; ++place)
                marks_[mesh.corner(place)] = suspect;
    }

    // The number of corners that are innocent, unless the count of one is greater than 1.
    std::size_t innocent(const Marks& corners) const {
        std::size_t count = 0;
        for (std::size_t row = 0; row < corners.size(); ++row)
            count += corners[row] & ~marks_[row] & 1;
        return count;
    }

    // Collects the half-edges between suspects; returns the sum of the counts of suspects.
    std::size_t collect(std::size_t first, std::size_t last, std::vector<HalfEdge>& edges) const {
        std::size_t sum = 0;
        for (std::size_t t = first; t < last; ++t) {
            prefetch(std::min(t + ahead, last - 1));
            if ((mark(3 * t) | mark(3 * t + 1) | mark(3 * t + 2)) == 0) continue;
            const int at = covering(t);
            sum += at != no_corner && mark(3 * t + at);
            for (int k = 0; k < 3; ++k)
                if (const HalfEdge edge = mesh_.half_edge(t, k);
                    marks_[edge.tail] & marks_[edge.head])
                    edges.push_back(edge);
        }
        return sum;
    }

    // Marks a row as `covered`, or as `several` if it was. Safe for several threads.
    void cover(std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) {
            prefetch(std::min(t + ahead, last - 1));
            const int at = covering(t);
            if (at == no_corner) continue;
            const platform::Shared shared(marks_[mesh_.corner(3 * t + at)]);
            const std::uint8_t bit = shared.load() & covered ? several : covered;
            if (shared.fetch_or(bit) & covered) shared.fetch_or(several);
        }
    }

    // Those that several triangles cover become suspect.
    void add_covered() {
        for (std::uint8_t& mark : marks_) mark = (mark & (suspect | several)) != 0;
    }

 private:
    static constexpr std::uint8_t suspect = 1, covered = 2, several = 4;
    static constexpr std::size_t ahead = 32;  // triangles

    void prefetch(std::size_t triangle) const {
        for (std::size_t place = 3 * triangle; place < 3 * triangle + 3; ++place)
            __builtin_prefetch(&mesh_.points[mesh_.corner(place)]);
    }

    std::uint8_t mark(std::size_t place) const { return marks_[mesh_.corner(place)]; }

    int covering(std::size_t triangle) const {
        const std::size_t first = 3 * triangle;
        return covering_corner(mesh_.point(first), mesh_.point(first + 1), mesh_.point(first + 2));
    }

    const MeshView& mesh_;
    Marks marks_;
};

// The repeated edges of one part: their ends, and pairs of half-edges with the same direction.
class Repeated {
 public:
    template <class It>
    void add(It first, It middle, It last, const MeshView& mesh) {
        if (std::max(middle - first, last - middle) < 2) return;
        ends.push_back(ends_of(*first));
        for (auto one = first; one != last; ++one) {
            if (one == first || one == middle) continue;
            const auto [low, high] = std::minmax(
                {mesh.callers_place(std::prev(one)->place), mesh.callers_place(one->place)});
            flaws.add(Flaw::non_manifold_edges, {high, low});
        }
    }

    std::vector<std::uint64_t> ends;
    Flaws flaws;
};

// Collects the half-edges between suspects, by blocks, and adds up the counts of suspects.
bool collect(const MeshView& mesh, ThreadPool& pool, const Suspects& suspects,
             std::vector<std::vector<HalfEdge>>& edges, std::size_t& sum) {
    edges.assign(blocks(mesh.count), {});
    std::vector<std::size_t> sums(edges.size());
    const auto work = [&](std::size_t first, std::size_t last, std::size_t task) {
        sums[task] = suspects.collect(first, last, edges[task]);
    };
    const bool done = in_blocks(mesh.count, block, pool, work);
    sum = std::accumulate(sums.begin(), sums.end(), std::size_t{0});
    return done;
}

bool find_suspects(const MeshView& mesh, const Marks& corners, ThreadPool& pool,
                   const EdgePairing& pairing, std::vector<std::vector<HalfEdge>>& edges) {
    Suspects suspects(mesh, pairing);
    std::size_t sum = 0;
    if (!collect(mesh, pool, suspects, edges, sum)) return false;
    if (pairing.covering - sum == suspects.innocent(corners)) return true;
    const auto cover = [&](std::size_t first, std::size_t last, auto) {
        suspects.cover(first, last);
    };
    if (!in_blocks(mesh.count, block, pool, cover)) return false;
    suspects.add_covered();
    return collect(mesh, pool, suspects, edges, sum);
}

// Removes the repeated edges from those that would be flipped.
void keep_undoubted(const MeshView& mesh, const std::vector<Repeated>& found,
                    std::vector<FlippableEdge>& flippable) {
    std::vector<std::uint64_t> ends;
    for (const Repeated& each : found) ends.insert(ends.end(), each.ends.begin(), each.ends.end());
    std::sort(ends.begin(), ends.end());
    std::erase_if(flippable, [&](const FlippableEdge& edge) {
        const HalfEdge one = mesh.half_edge(edge.one / 3, static_cast<int>(edge.one % 3));
        return std::binary_search(ends.begin(), ends.end(), ends_of(one));
    });
}

}  // namespace

bool separate_repeated(const MeshView& mesh, const Marks& corners, ThreadPool& pool,
                       EdgePairing& pairing, Flaws& flaws) {
    std::vector<std::vector<HalfEdge>> suspects;
    if (!find_suspects(mesh, corners, pool, pairing, suspects)) return false;
    const HashPartition<HalfEdge, EdgeHash> parts(suspects, pool);
    if (!parts.complete()) return false;
    std::vector<Repeated> found(parts.size());
    const bool done = pool.run(parts.size(), [&](std::size_t part) {
        parts.for_each_bucket(part, [&](std::span<HalfEdge> edges) {
            for_each_edge(edges, [&](auto first, auto middle, auto last) {
                found[part].add(first, middle, last, mesh);
            });
        });
    });
    for (const Repeated& each : found) flaws.add(each.flaws);
    if (!pairing.flippable.empty()) keep_undoubted(mesh, found, pairing.flippable);
    return done;
}

}  // namespace liftmesh
