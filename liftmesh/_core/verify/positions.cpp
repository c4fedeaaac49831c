// Rows at one position fall into one bucket of a hash partition, and sorting the bucket separates
// the positions: O(n log n) on every input.

#include "verify/positions.hpp"

#include <algorithm>
#include <numeric>
#include <span>

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

std::vector<std::vector<PlacedRow>> finite_rows(const MeshView& mesh, ThreadPool& pool) {
    std::vector<std::vector<PlacedRow>> shares(blocks(mesh.rows));
    pool.run(shares.size(), [&](std::size_t task) {
        const std::size_t last = std::min(mesh.rows, (task + 1) * block);
        shares[task].reserve(last - task * block);
        for (std::size_t row = task * block; row < last; ++row)
            if (const Point p = mesh.points[row]; is_finite(p))
                shares[task].push_back({p, static_cast<Row>(row)});
    });
    return shares;
}

// Calls visit(rows), on any thread, for the finite rows at each position in ascending order.
template <class Visit>
bool for_each_position(const MeshView& mesh, ThreadPool& pool, Visit visit) {
    const HashPartition<PlacedRow, PositionHash> parts(finite_rows(mesh, pool), pool);
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
    const bool done = for_each_position(mesh, pool, [&](std::span<PlacedRow> rows) {
        const auto is_vertex = [&](const PlacedRow& placed) { return vertices[placed.row] != 0; };
        if (std::any_of(rows.begin(), rows.end(), is_vertex)) return;
        for (const PlacedRow& placed : rows) missing[placed.row] = 1;
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
