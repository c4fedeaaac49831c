// Rows at one position meet in one handful, where sorting tells them apart: O(n log n) whatever the
// rows.

#include "verify/positions.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>

#include "base/input.hpp"
#include "verify/parts.hpp"

namespace liftmesh {

namespace {

struct Placed {
    Point point;
    Row row;
};

struct HashOfPosition {
    std::uint64_t operator()(const Placed& placed) const {
        return std::bit_cast<std::uint64_t>(placed.point.x) * 0x9e3779b97f4a7c15u +
               std::bit_cast<std::uint64_t>(placed.point.y) * 0xd1b54a32d192ed03u;
    }
};

std::vector<std::vector<Placed>> finite_rows(const Subject& subject, ThreadPool& pool) {
    std::vector<std::vector<Placed>> shares(blocks(subject.rows));
    pool.run(shares.size(), [&](std::size_t task) {
        const std::size_t last = std::min(subject.rows, (task + 1) * block);
        shares[task].reserve(last - task * block);
        for (std::size_t row = task * block; row < last; ++row)
            if (const Point p = subject.points[row]; is_finite(p))
                shares[task].push_back({p, static_cast<Row>(row)});
    });
    return shares;
}

// Calls visit(rows) for the finite rows at each position, ascending; any thread may.
template <class Visit>
bool for_each_position(const Subject& subject, ThreadPool& pool, Visit visit) {
    const Parts<Placed, HashOfPosition> parts(finite_rows(subject, pool), pool);
    return parts.whole() && pool.run(parts.size(), [&](std::size_t part) {
        parts.for_each_handful(part, [&](std::span<Placed> some) {
            std::sort(some.begin(), some.end(), [](const Placed& p, const Placed& q) {
                return before_xy(p.point, q.point) || (p.point == q.point && p.row < q.row);
            });
            for (auto first = some.begin(); first != some.end();) {
                const auto last = std::find_if(first, some.end(), [&](const Placed& placed) {
                    return !(placed.point == first->point);
                });
                visit(std::span(first, last));
                first = last;
            }
        });
    });
}

}  // namespace

bool find_missing(const Subject& subject, const Marks& vertices, ThreadPool& pool, Flaws& flaws) {
    Marks missing(subject.rows);
    const bool done = for_each_position(subject, pool, [&](std::span<Placed> rows) {
        const auto is_vertex = [&](const Placed& placed) { return vertices[placed.row] != 0; };
        if (std::any_of(rows.begin(), rows.end(), is_vertex)) return;
        for (const Placed& placed : rows) missing[placed.row] = 1;
    });
    for (std::size_t row = 0; row < subject.rows; ++row)
        if (missing[row]) flaws.add(Flaw::missing, {row, 0});
    return done;
}

bool find_lowest(const Subject& subject, ThreadPool& pool, std::vector<Row>& lowest) {
    lowest.resize(subject.rows);
    std::iota(lowest.begin(), lowest.end(), Row{0});
    return for_each_position(subject, pool, [&](std::span<Placed> rows) {
        for (const Placed& placed : rows) lowest[placed.row] = rows.front().row;
    });
}

}  // namespace liftmesh
