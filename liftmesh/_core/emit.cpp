// A triangle's place in the result is the number of real triangles in the slots before its own. A
// bit for each real slot, with a running count for each 64 of them, answers that in two loads; most
// words have no ghost at all, and then nothing needs counting.

#include "emit.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "blocks.hpp"

namespace liftmesh {

namespace {

class Ranks {
 public:
    Ranks(const Mesh& mesh, std::size_t slots) : bits_((slots + 63) / 64), before_(bits_.size()) {
        std::uint32_t count = 0;
        for (std::size_t word = 0; word < bits_.size(); ++word) {
            before_[word] = count;
            const std::size_t end = std::min(slots, 64 * (word + 1));
            for (std::size_t t = 64 * word; t < end; ++t)
                bits_[word] |= std::uint64_t{!mesh[static_cast<TriangleId>(t)].is_ghost()}
                               << (t % 64);
            count += static_cast<std::uint32_t>(std::popcount(bits_[word]));
        }
        total_ = count;
    }

    std::size_t total() const { return total_; }
    std::int32_t operator[](TriangleId t) const {
        const std::uint64_t word = bits_[t / 64];
        if (word == ~std::uint64_t{0}) return static_cast<std::int32_t>(before_[t / 64] + t % 64);
        if ((word >> (t % 64) & 1) == 0) return -1;
        const std::uint64_t lower = word & ((std::uint64_t{1} << (t % 64)) - 1);
        return static_cast<std::int32_t>(before_[t / 64] +
                                         static_cast<std::uint32_t>(std::popcount(lower)));
    }

 private:
    std::vector<std::uint64_t> bits_;
    std::vector<std::uint32_t> before_;
    std::size_t total_ = 0;
};

// Starts at the lexicographically least point, which is on the hull.
void emit_hull(const Mesh& mesh, TriangleId any, const Row* rows, std::int32_t* hull) {
    TriangleId start = any;
    for (TriangleId g = mesh.successor(any); g != any; g = mesh.successor(g))
        if (before_xy(mesh.point(mesh.tail(g)), mesh.point(mesh.tail(start)))) start = g;
    TriangleId g = start;
    do {
        *hull++ = static_cast<std::int32_t>(rows[mesh.tail(g)]);
        g = mesh.successor(g);
    } while (g != start);
}

}  // namespace

Status emit(const Mesh& mesh, const Row* rows, std::size_t points, Interrupt& interrupt,
            Result& result) {
    const std::size_t slots = 2 * points - 2;
    const Ranks ranks(mesh, slots);
    result.triangle_count = ranks.total();
    result.hull_count = slots - ranks.total();
    result.simplices = std::make_unique_for_overwrite<std::int32_t[]>(3 * result.triangle_count);
    result.neighbors = std::make_unique_for_overwrite<std::int32_t[]>(3 * result.triangle_count);
    result.hull = std::make_unique_for_overwrite<std::int32_t[]>(result.hull_count);

    std::int32_t* simplex = result.simplices.get();
    std::int32_t* neighbor = result.neighbors.get();
    TriangleId some_ghost = 0;
    const bool done = for_each_in_blocks(slots, interrupt, [&](std::size_t slot) {
        const Triangle& triangle = mesh[static_cast<TriangleId>(slot)];
        if (triangle.is_ghost()) {
            some_ghost = static_cast<TriangleId>(slot);
            return;
        }
        for (int k = 0; k < 3; ++k) {
            *simplex++ = static_cast<std::int32_t>(rows[triangle.vertex[k]]);
            *neighbor++ = ranks[triangle_of(triangle.twin[k])];
        }
    });
    if (!done) return Status::interrupted;
    emit_hull(mesh, some_ghost, rows, result.hull.get());
    return result.triangle_count == 0 ? Status::collinear : Status::ok;
}

}  // namespace liftmesh
