#include "anisotropic/stars.hpp"

#include <algorithm>

#include "anisotropic/star.hpp"

namespace liftmesh::anisotropic {

namespace {

constexpr Row nobody = ~Row{0};

// Of each row on the hull, the next and the one before.
struct Hull {
    std::vector<Row> next, before;

    Hull(std::size_t count, std::span<const std::int32_t> pairs)
        : next(count, nobody), before(count, nobody) {
        for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
            const auto a = static_cast<Row>(pairs[i]), b = static_cast<Row>(pairs[i + 1]);
            next[a] = b;
            before[b] = a;
        }
    }
};

std::vector<Row> neighbors_of(const Given& given, const Hull& hull, Row p) {
    const auto all =
        given.neighbors.subspan(static_cast<std::size_t>(given.starts[p]),
                                static_cast<std::size_t>(given.starts[p + 1] - given.starts[p]));
    std::vector<Row> rows(all.begin(), all.end());
    if (hull.next[p] != nobody) {
        std::iter_swap(rows.begin(), std::find(rows.begin(), rows.end(), hull.next[p]));
        std::iter_swap(rows.end() - 1, std::find(rows.begin(), rows.end(), hull.before[p]));
    }
    return rows;
}

std::vector<Row> vertices_of(const Given& given) {
    std::vector<Row> rows;
    for (Row p = 0; p < given.points.size(); ++p)
        if (given.starts[p + 1] > given.starts[p]) rows.push_back(p);
    return rows;
}

// Lists that were made in another order, by row.
Lists by_row(const std::vector<Row>& order, const Lists& made, std::size_t count) {
    Lists found{std::vector<std::int64_t>(count + 1, 0), {}};
    for (std::size_t i = 0; i < order.size(); ++i)
        found.starts[order[i] + 1] = made.starts[i + 1] - made.starts[i];
    for (std::size_t i = 0; i < count; ++i) found.starts[i + 1] += found.starts[i];
    found.rows.resize(made.rows.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        std::copy(made.rows.begin() + made.starts[i], made.rows.begin() + made.starts[i + 1],
                  found.rows.begin() + found.starts[order[i]]);
    return found;
}

}  // namespace

bool stars(const Given& given, Interrupt& interrupt, Lists& found) {
    const Hull hull(given.points.size(), given.hull);
    const Points points = scaled(given.points);
    const KdTree tree(points.scaled, vertices_of(given));
    Star star(points, tree);
    Lists made{{0}, {}};
    interrupt.expect(tree.rows().size());
    for (const Row p : tree.rows()) {
        star.build(p, given.metrics[p], neighbors_of(given, hull, p), hull.next[p] != nobody);
        star.write(made.rows);
        made.starts.push_back(static_cast<std::int64_t>(made.rows.size()));
        if (made.starts.size() % 64 != 0) continue;
        interrupt.advance(64);
        if (interrupt.requested()) return false;
    }
    found = by_row(tree.rows(), made, given.points.size());
    return true;
}

}  // namespace liftmesh::anisotropic
