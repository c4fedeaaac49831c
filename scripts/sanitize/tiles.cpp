#include "tiles.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "tiles/frontier.hpp"
#include "tiles/partition.hpp"

namespace parallel {

namespace {

using liftmesh::Box;
using liftmesh::Cut;
using liftmesh::Node;
using liftmesh::Partition;
using liftmesh::Point;
using liftmesh::Record;
using liftmesh::RimEdge;
using liftmesh::Status;
using liftmesh::Territory;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Box everywhere = {{-infinity, -infinity}, {infinity, infinity}};

class Patient final : public liftmesh::Interrupt {
 public:
    explicit Patient(std::size_t patience) : patience_(patience) {}
    bool requested() override { return asked_ >= patience_ || ++asked_ >= patience_; }

 private:
    std::size_t patience_, asked_ = 0;
};

void demand(bool condition, const Cloud& cloud, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "FIND: %s, tiles: %s\n", cloud.name.c_str(), what);
    std::exit(1);
}

Node merged(std::span<const Record> records, std::span<const RimEdge> rim,
            const Territory& territory, unsigned threads, std::size_t patience) {
    Patient interrupt(patience);
    return liftmesh::merge_frontiers(records, rim, territory, true, {threads, false}, interrupt);
}

template <class Item>
bool equal(const Item* a, const Item* b, std::size_t count) {
    return count == 0 || std::memcmp(a, b, count * sizeof(Item)) == 0;
}

bool same(const Node& a, const Node& b) {
    const std::size_t corners = 3 * a.triangle_count, up = a.frontier.size(), rim = a.rim.size();
    return a.status == b.status && a.triangle_count == b.triangle_count &&
           up == b.frontier.size() && rim == b.rim.size() &&
           equal(a.triangles.get(), b.triangles.get(), corners) &&
           equal(a.neighbors.get(), b.neighbors.get(), corners) &&
           equal(a.frontier.data(), b.frontier.data(), up) &&
           equal(a.rim.data(), b.rim.data(), rim);
}

Node checked(const Cloud& cloud, std::span<const Record> records, std::span<const RimEdge> rim,
             const Territory& territory) {
    constexpr std::size_t forever = ~std::size_t{0};
    Node alone = merged(records, rim, territory, 1, forever);
    for (const unsigned threads : {2u, 4u})
        demand(same(alone, merged(records, rim, territory, threads, forever)), cloud,
               "threads change the result");
    for (const std::size_t patience : {1u, 5u, 30u}) {
        const Node found = merged(records, rim, territory, 3, patience);
        demand(found.status == Status::interrupted || same(found, alone), cloud,
               "a run that could be interrupted comes to another result");
    }
    demand(alone.missing == 0, cloud, "frontiers do not fit");
    return alone;
}

// How many triangles of a node have circles that reach a point.
std::size_t reaching(const Cloud& cloud, const Node& node, liftmesh::Point at) {
    const std::vector<std::int32_t> rows(node.triangles.get(),
                                         node.triangles.get() + 3 * node.triangle_count);
    const liftmesh::Corners faces{cloud.points, rows};
    demand(faces.are_valid(), cloud, "a triangle has a corner that is no row");
    const auto flags = liftmesh::allocate<bool>(faces.count());
    liftmesh::find_reaching(faces, {at, at}, flags.get());
    const Box reach = liftmesh::reach_of(faces);
    const auto count =
        static_cast<std::size_t>(std::count(flags.get(), flags.get() + faces.count(), true));
    demand(count == 0 || (reach.low.x <= at.x && at.x <= reach.high.x), cloud,
           "a circle is not within the box of all");
    return count;
}

}  // namespace

void check_tiles(const Cloud& cloud, std::size_t triangles) {
    const Cut cut{liftmesh::Axis::x, cloud.points[cloud.points.size() / 2], {~0, ~1}};
    if (!liftmesh::is_finite(cut.at)) return;
    Patient interrupt(~std::size_t{0});
    const Partition parts = liftmesh::partition(cloud.input(), 0, {&cut, 1}, 2, interrupt);
    std::vector<Record> records;
    std::vector<RimEdge> rim;
    std::size_t found = 0, near = 0;
    for (const std::size_t t : {0u, 1u}) {
        const auto first = static_cast<std::size_t>(parts.begins[t]);
        const auto end = static_cast<std::size_t>(parts.begins[t + 1]);
        Box cell = everywhere;
        (t == 0 ? cell.high.x : cell.low.x) = cut.at.x;
        const Territory territory{cell, {&parts.boxes[1 - t], 1}, false};
        const Node node = checked(cloud, {&parts.records[first], end - first}, {}, territory);
        found += node.triangle_count;
        near += reaching(cloud, node, cut.at);
        const auto begin = static_cast<std::int32_t>(records.size());
        records.insert(records.end(), node.frontier.begin(), node.frontier.end());
        for (const RimEdge& e : node.rim) rim.push_back({e.tail + begin, e.head + begin});
    }
    const Node root = checked(cloud, records, rim, {everywhere, {}, true});
    found += root.triangle_count;
    near += reaching(cloud, root, cut.at);
    demand(near > 0 || found == 0, cloud, "no circle reaches a vertex");
    demand(found == triangles, cloud, "triangles are missing, or there are too many");
}

}  // namespace parallel
