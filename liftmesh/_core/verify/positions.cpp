// Nearly all rows have a position of their own, and are alone in their slots
// (`hash_partition.hpp`). The few that are not go through a hash partition, and sorting a bucket
// separates the positions: O(n log n) on every input.

#include "base/input.hpp"
#include "base/point.hpp"
#include "verify/edge_pairing.hpp"
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

// The finite rows that may share their position with another.
std::vector<std::vector<PlacedRow>> doubtful_rows(const MeshView& mesh, ThreadPool& pool) {
    Slots slots(mesh.rows);
    std::vector<std::vector<PlacedRow>> shares(blocks(mesh.rows));
    const auto for_each_finite = [&](std::size_t task, auto visit) {
        const auto hash_of = [&](std::size_t row) { return hash(mesh.points[row]); };
        const auto visit_finite = [&](std::size_t row, std::uint64_t hash) {
            if (mesh.finite || is_finite(mesh.points[row])) visit(row, hash);
        };
        const std::size_t last = std::min(mesh.rows, (task + 1) * block);
        slots.for_each(task * block, last, hash_of, visit_finite);
    };
    const bool done = pool.run(shares.size(), [&](std::size_t task) {
        for_each_finite(task, [&](auto, std::uint64_t hash) { slots.add(hash); });
    });
    if (!done) return shares;
    pool.run(shares.size(), [&](std::size_t task) {
        for_each_finite(task, [&](std::size_t row, std::uint64_t hash) {
            if (slots.is_shared(hash))
                shares[task].push_back({mesh.points[row], static_cast<Row>(row)});
        });
    });
    return shares;
}

double value_of(const MeshView& mesh, const PlacedRow& placed) {
    return mesh.values == nullptr ? 0 : mesh.values[placed.row];
}

// Calls visit(rows), on any thread, for the rows at each position, and of one value, in ascending
// order, unless a single row is known to be alone. False if the interrupt came first.
template <class Visit>
bool for_each_position(const MeshView& mesh, ThreadPool& pool, Visit visit) {
    const HashPartition<PlacedRow, PositionHash> parts(doubtful_rows(mesh, pool), pool);
    return parts.complete() && pool.run(parts.size(), [&](std::size_t part) {
        parts.for_each_bucket(part, [&](std::span<PlacedRow> bucket) {
            std::sort(bucket.begin(), bucket.end(), [&](const PlacedRow& p, const PlacedRow& q) {
                if (!(p.point == q.point)) return before_xy(p.point, q.point);
                const double at_p = value_of(mesh, p), at_q = value_of(mesh, q);
                return at_p < at_q || (at_p == at_q && p.row < q.row);
            });
            for (auto first = bucket.begin(); first != bucket.end();) {
                const auto last = std::find_if(first, bucket.end(), [&](const PlacedRow& placed) {
                    return !(placed.point == first->point) ||
                           value_of(mesh, placed) != value_of(mesh, *first);
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
