#include "tiles.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "rows.hpp"
#include "tiles/frontier.hpp"
#include "tiles/partition.hpp"

namespace portability {

namespace {

using liftmesh::Box;
using liftmesh::Node;
using liftmesh::Partition;
using liftmesh::Point;
using liftmesh::Record;
using liftmesh::RimEdge;
using liftmesh::Territory;
using liftmesh::Threads;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Box everywhere = {{-infinity, -infinity}, {infinity, infinity}};
constexpr Threads three{3, false};

void add(Digest& digest, const Box& box) {
    for (const Point p : {box.low, box.high}) {
        digest.add(p.x);
        digest.add(p.y);
    }
}

Digest digest_of(const Node& node) {
    Digest digest;
    digest.add(node.status);
    digest.add(node.missing);
    if (const std::size_t corners = 3 * node.triangle_count; corners > 0) {
        digest.add(node.triangles.get(), corners * sizeof(liftmesh::RowId));
        digest.add(node.neighbors.get(), corners * sizeof(std::int32_t));
    }
    for (const liftmesh::RowPair pair : node.duplicates) {
        digest.add(pair.row);
        digest.add(pair.kept);
    }
    for (const liftmesh::RowId row : node.hull) digest.add(row);
    for (const Record& record : node.frontier) digest.add(record.id);
    for (const RimEdge edge : node.rim) {
        digest.add(edge.tail);
        digest.add(edge.head);
    }
    return digest;
}

Node merged(std::span<const Record> records, std::span<const RimEdge> rim,
            const Territory& territory, Digest& digest) {
    liftmesh::NoInterrupt never;
    Node node = liftmesh::merge_frontiers(records, rim, territory, true, {}, never);
    if (three.for_rows(records.size()).limit > 1)
        demand(digest_of(liftmesh::merge_frontiers(records, rim, territory, true, three, never))
                       .value() == digest_of(node).value(),
               "threads differ");
    digest.add(digest_of(node).value());
    return node;
}

// Which faces of a node may have a point of a box inside their circles, and how far these go.
void add_reach(std::span<const Point> points, const Node& node, const Box& box, Digest& digest) {
    const std::vector<std::int32_t> rows(node.triangles.get(),
                                         node.triangles.get() + 3 * node.triangle_count);
    const liftmesh::Corners faces{points, rows};
    const auto flags = liftmesh::allocate<bool>(faces.count());
    liftmesh::find_reaching(faces, box, flags.get());
    for (std::size_t face = 0; face < faces.count(); ++face) digest.add(flags[face]);
    add(digest, liftmesh::reach_of(faces));
}

}  // namespace

void add_tiles(const double* coordinates, std::size_t rows, Digests& digests) {
    const std::span<const Point> points(reinterpret_cast<const Point*>(coordinates), rows);
    const liftmesh::Cut cut{liftmesh::Axis::x, points[rows / 2], {~0, ~1}};
    if (!liftmesh::is_finite(cut.at)) return;
    liftmesh::NoInterrupt never;
    Digest &nodes = digests.of["tiles"], &reach = digests.of["reach of faces"];
    const Partition parts =
        liftmesh::partition(native::input_of(coordinates, rows), 0, {&cut, 1}, 2, never);
    std::vector<Record> records;
    std::vector<RimEdge> rim;
    for (const std::size_t t : {0u, 1u}) {
        const auto first = static_cast<std::size_t>(parts.begins[t]);
        const auto end = static_cast<std::size_t>(parts.begins[t + 1]);
        Box cell = everywhere;
        (t == 0 ? cell.high.x : cell.low.x) = cut.at.x;
        add(nodes, parts.boxes[t]);
        const Node node = merged({&parts.records[first], end - first}, {},
                                 {cell, {&parts.boxes[1 - t], 1}, false}, nodes);
        add_reach(points, node, parts.boxes[1 - t], reach);
        const auto begin = static_cast<std::int32_t>(records.size());
        records.insert(records.end(), node.frontier.begin(), node.frontier.end());
        for (const RimEdge e : node.rim) rim.push_back({e.tail + begin, e.head + begin});
    }
    const Node root = merged(records, rim, {everywhere, {}, true}, nodes);
    demand(root.missing == 0, "frontiers do not fit");
    add_reach(points, root, {cut.at, cut.at}, reach);
}

}  // namespace portability
