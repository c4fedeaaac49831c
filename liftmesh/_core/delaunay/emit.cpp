// A triangle's row in the output is its rank among the slots that hold no ghost. The ghosts are
// found along the hull. A bit for each slot, clear for ghosts, with a running count for each word
// of 64, answers in two loads; most words have no ghost at all, and then no bits are counted.

#include "delaunay/emit.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "delaunay/mesh.hpp"

namespace liftmesh {

namespace {

class Ranks {
 public:
    explicit Ranks(std::size_t slots)
        : bits_((slots + 63) / 64, ~std::uint64_t{0}), before_(bits_.size()) {
        if (slots % 64 != 0) bits_.back() = bit(slots) - 1;
    }

    void leave_out(std::size_t t) { bits_[t / 64] &= ~bit(t); }

    void count() {
        std::uint32_t count = 0;
        for (std::size_t word = 0; word < bits_.size(); ++word) {
            before_[word] = count;
            count += static_cast<std::uint32_t>(std::popcount(bits_[word]));
        }
    }

    // The rank of the first slot of a word.
    std::size_t before(std::size_t word) const { return before_[word]; }

    bool has(std::size_t t) const { return bits_[t / 64] & bit(t); }

    // -1 for a ghost.
    std::int32_t operator[](std::size_t t) const {
        const std::uint64_t word = bits_[t / 64];
        if (word == ~std::uint64_t{0}) return static_cast<std::int32_t>(before_[t / 64] + t % 64);
        if ((word & bit(t)) == 0) return -1;
        return static_cast<std::int32_t>(
            before_[t / 64] + static_cast<std::uint32_t>(std::popcount(word & (bit(t) - 1))));
    }

 private:
    static std::uint64_t bit(std::size_t t) { return std::uint64_t{1} << (t % 64); }

    std::vector<std::uint64_t> bits_;
    std::vector<std::uint32_t> before_;
};

// The ghosts along the hull, counter-clockwise from the lexicographically least point.
std::vector<TriangleId> ghosts_of(const Mesh& mesh, TriangleId any) {
    std::vector<TriangleId> ghosts{any};
    std::size_t least = 0;
    for (TriangleId g = mesh.successor(any); g != any; g = mesh.successor(g)) {
        if (before_xy(mesh.point(mesh.tail(g)), mesh.point(mesh.tail(ghosts[least]))))
            least = ghosts.size();
        ghosts.push_back(g);
    }
    std::rotate(ghosts.begin(), ghosts.begin() + static_cast<std::ptrdiff_t>(least), ghosts.end());
    return ghosts;
}

class Emission {
 public:
    Emission(const Construction& from, const Ranks& ranks, Result& result)
        : from_(from), ranks_(ranks), result_(result) {}

    // Slots from `first` on, a multiple of 64.
    void slots(std::size_t first, std::size_t last) const {
        const std::size_t rank = ranks_.before(first / 64);
        std::int32_t* simplex = &result_.simplices[3 * rank];
        std::int32_t* neighbor = &result_.neighbors[3 * rank];
        for (std::size_t slot = first; slot < last; ++slot) {
            if (!ranks_.has(slot)) continue;
            const Word* vertex = &from_.triangles[triangle_in(slot)];
            const Edge* twin = vertex + 3;
            for (int k = 0; k < 3; ++k) {
                *simplex++ = static_cast<std::int32_t>(from_.rows[vertex[k]]);
                *neighbor++ = ranks_[slot_of(twin[k])];
            }
        }
    }

 private:
    const Construction& from_;
    const Ranks& ranks_;
    Result& result_;
};

}  // namespace

Status emit(const Construction& from, ThreadPool& pool, Memory left, Result& result) {
    constexpr std::size_t block = std::size_t{1} << 16;
    const Mesh mesh(from.points.get(), from.triangles.get());
    const std::size_t slots = 2 * from.count - 2;
    const std::vector<TriangleId> ghosts = ghosts_of(mesh, from.some_ghost);
    Ranks ranks(slots);
    for (const TriangleId g : ghosts) ranks.leave_out(slot_of(g));
    ranks.count();
    result.make_room(slots - ghosts.size(), ghosts.size(), std::move(left));
    std::transform(ghosts.begin(), ghosts.end(), result.hull.get(), [&](TriangleId g) {
        return static_cast<std::int32_t>(from.rows[mesh.tail(g)]);
    });
    const Emission emission(from, ranks, result);
    const bool done = pool.run((slots + block - 1) / block, [&](std::size_t i) {
        emission.slots(i * block, std::min(slots, (i + 1) * block));
        pool.interrupt().advance(work::emitting * block / 2);
    });
    if (!done) return Status::interrupted;
    return result.triangle_count == 0 ? Status::collinear : Status::ok;
}

}  // namespace liftmesh
