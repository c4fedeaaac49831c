// Nearly all rows have a position of their own. A hash sends each row to one of many slots, and a
// row that is alone in its slot shares its position with no other. The few that are not go through
// a hash partition, and sorting a bucket separates the positions: O(n log n) on every input.

#include "verify/positions.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/input.hpp"
#include "base/point_hash.hpp"
#include "verify/hash_partition.hpp"

namespace liftmesh {

namespace {

struct PlacedRow {
    Point point;
    Row row;
};

struct PositionHash {
    std::uint64_t operator()(const PlacedRow& placed) const { return hash(placed.point); }
};

// Two bits for each slot: whether a row fell into it, and whether a second one did.
class Slots {
 public:
    explicit Slots(std::size_t rows)
        : bits_(static_cast<int>(std::bit_width(per_row * rows / per_word))),
          words_(std::size_t{1} << bits_) {}

    std::uint64_t* word(std::uint64_t hash) {
        return &words_[bits_ == 0 ? 0 : hash >> (64 - bits_)];
    }

    // Safe for several threads.
    void add(std::uint64_t hash) {
        const std::atomic_ref<std::uint64_t> shared(*word(hash));
        const std::uint64_t one = std::uint64_t{1} << place(hash);
        const std::uint64_t before = shared.fetch_or(one, std::memory_order_relaxed);
        if (before & one) shared.fetch_or(one << 1, std::memory_order_relaxed);
    }

    bool is_shared(std::uint64_t hash) { return *word(hash) >> place(hash) & 2; }

 private:
    static constexpr std::size_t per_row = 16, per_word = 32;

    int place(std::uint64_t hash) const { return static_cast<int>(hash >> (59 - bits_) & 31) * 2; }

    int bits_;
    std::vector<std::uint64_t> words_;
};

// Calls visit(row, hash) for the finite ones of a block of rows. Their words are prefetched.
template <class Visit>
void for_each_finite(const MeshView& mesh, std::size_t task, Slots& slots, Visit visit) {
    constexpr std::size_t abreast = 64;
    const std::size_t end = std::min(mesh.rows, (task + 1) * block);
    for (std::size_t first = task * block; first < end; first += abreast) {
        const std::size_t last = std::min(end, first + abreast);
        std::uint64_t hashes[abreast];
        for (std::size_t row = first; row < last; ++row)
            __builtin_prefetch(slots.word(hashes[row - first] = hash(mesh.points[row])), 1);
        for (std::size_t row = first; row < last; ++row)
            if (is_finite(mesh.points[row])) visit(row, hashes[row - first]);
    }
}

// The finite rows that may share their position with another.
std::vector<std::vector<PlacedRow>> doubtful_rows(const MeshView& mesh, ThreadPool& pool) {
    Slots slots(mesh.rows);
    std::vector<std::vector<PlacedRow>> shares(blocks(mesh.rows));
    const bool done = pool.run(shares.size(), [&](std::size_t task) {
        for_each_finite(mesh, task, slots, [&](auto, std::uint64_t hash) { slots.add(hash); });
    });
    if (!done) return shares;
    pool.run(shares.size(), [&](std::size_t task) {
        for_each_finite(mesh, task, slots, [&](std::size_t row, std::uint64_t hash) {
            if (slots.is_shared(hash))
                shares[task].push_back({mesh.points[row], static_cast<Row>(row)});
        });
    });
    return shares;
}

// Calls visit(rows), on any thread, for the rows at each position in ascending order, unless a
// single row is known to be alone. False if the interrupt came first.
template <class Visit>
bool for_each_position(const MeshView& mesh, ThreadPool& pool, Visit visit) {
    const HashPartition<PlacedRow, PositionHash> parts(doubtful_rows(mesh, pool), pool);
    return parts.complete() && pool.run(parts.size(), [&](std::size_t part) {
        parts.for_each_bucket(part, [&](std::span<PlacedRow> bucket) {
            std::sort(bucket.begin(), bucket.end(), [](const PlacedRow& p, const PlacedRow& q) {
                return before_xy(p.point, q.point) || (p.point == q.point && p.row < q.row);
            });
            for (auto first = bucket.begin(); first != bucket.end();) {
                const auto last = std::find_if(first, bucket.end(), [&](const PlacedRow& placed) {
                    return !(placed.point == first->point);
                });
                visit(std::span(first, last));
                first = last;
            }
        });
    });
}

}  // namespace

bool find_missing(const MeshView& mesh, const Marks& vertices, ThreadPool& pool, Flaws& flaws) {
    Marks missing(mesh.rows);
    for (std::size_t row = 0; row < mesh.rows; ++row)
        missing[row] = !vertices[row] && is_finite(mesh.points[row]);
    const bool done = for_each_position(mesh, pool, [&](std::span<PlacedRow> rows) {
        const auto is_vertex = [&](const PlacedRow& placed) { return vertices[placed.row] != 0; };
        if (std::none_of(rows.begin(), rows.end(), is_vertex)) return;
        for (const PlacedRow& placed : rows) missing[placed.row] = 0;
    });
    for (std::size_t row = 0; row < mesh.rows; ++row)
        if (missing[row]) flaws.add(Flaw::missing_vertices, {row, 0});
    return done;
}

bool find_lowest(const MeshView& mesh, ThreadPool& pool, std::vector<Row>& lowest) {
    lowest.resize(mesh.rows);
    std::iota(lowest.begin(), lowest.end(), Row{0});
    return for_each_position(mesh, pool, [&](std::span<PlacedRow> rows) {
        for (const PlacedRow& placed : rows) lowest[placed.row] = rows.front().row;
    });
}

}  // namespace liftmesh
