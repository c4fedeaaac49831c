// Most constraints are edges. They are listed at the lower rows of their ends, and one pass over
// the half-edges finds these.
//
// Any other is followed from its lesser end, by x, then y: the next edge is the one whose end lies
// exactly in the direction of the other end. Each edge is listed at its lesser end, so those of one
// vertex lie within half a turn, and orientations alone sort them by direction: many are sorted
// once, and searched. Constraints may lie on top of each other: edges that one has followed are
// linked to chains, and another one goes to the end of a chain at once, by union-find. So all of it
// takes O(n log n).

#include "verify/constraints.hpp"

#include "parallel/blocks.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t few = 24;  // edges of a vertex, which are not sorted

// Lists numbered items by rows: calls visit(i, key), twice for each, and fills `items` with
// item(i), those of a row from first[row] to first[row + 1].
template <class Item, class ForEach, class Make>
bool list_by_rows(std::size_t rows, ForEach for_each, std::vector<std::uint32_t>& first,
                  Buffer<Item>& items, Make make) {
    first.assign(rows + 1, 0);
    if (!for_each([&](Row row, auto...) { ++first[row]; })) return false;
    std::partial_sum(first.begin(), first.end(), first.begin());
    items = allocate<Item>(first.back());
    return for_each([&](Row row, auto... item) { items[--first[row]] = make(item...); });
}

// Those constraints from each row on.
struct Listed {
    Row end;
    std::uint32_t segment;
    auto operator<=>(const Listed&) const = default;
};

}  // namespace

bool ConstrainedEdges::match(std::vector<FollowedEdge>& segments) {
    std::vector<std::uint32_t> first;
    Buffer<Listed> listed;
    const auto for_each_segment = [&](auto visit) {
        return for_each_in_blocks(segments.size(), pool_.interrupt(), [&](std::size_t i) {
            const auto [low, high] = std::minmax(segments[i].from, segments[i].to);
            visit(low, high, static_cast<std::uint32_t>(i));
        });
    };
    const auto make = [](Row end, std::uint32_t segment) { return Listed{end, segment}; };
    if (!list_by_rows(mesh_.rows, for_each_segment, first, listed, make)) return false;
    for (std::size_t row = 0; row < mesh_.rows; ++row)
        std::sort(&listed[first[row]], &listed[first[row + 1]]);
    return in_blocks(mesh_.count, block, pool_, [&](std::size_t t, std::size_t last, auto) {
        for (std::size_t place = 3 * t; place < 3 * last; ++place) {
            const HalfEdge edge = mesh_.half_edge(place / 3, static_cast<int>(place % 3));
            const auto [low, high] = std::minmax(edge.tail, edge.head);
            if (first[low] == first[low + 1]) continue;
            const Listed *const start = &listed[first[low]], *const end = &listed[first[low + 1]];
            const Listed* at = std::lower_bound(start, end, Listed{high, 0});
            for (; at != end && at->end == high; ++at) {
                FollowedEdge& found = segments[at->segment];
                platform::Shared(found.reached).store(found.to);
                marked_[place] = 1;
            }
        }
    });
}

bool ConstrainedEdges::collect() {
    const Point* const points = mesh_.points;
    const auto for_each_edge = [&](auto visit) {
        return for_each_in_blocks(3 * mesh_.count, pool_.interrupt(), [&](std::size_t place) {
            const auto [tail, head, at] = mesh_.half_edge(place / 3, static_cast<int>(place % 3));
            if (before_xy(points[tail], points[head])) visit(tail, head, at);
            if (before_xy(points[head], points[tail])) visit(head, tail, at);
        });
    };
    const auto make = [](Row end, std::uint32_t place) { return Edge{end, place}; };
    if (!list_by_rows(mesh_.rows, for_each_edge, first_, edges_, make)) return false;
    chain_.assign(3 * mesh_.count, none);
    return in_blocks(mesh_.rows, block, pool_, [&](std::size_t row, std::size_t last, auto) {
        for (; row < last; ++row) {
            if (first_[row + 1] - first_[row] <= few) continue;
            std::sort(&edges_[first_[row]], &edges_[first_[row + 1]],
                      [&](const Edge& p, const Edge& q) {
                          return orient2d(points[row], points[p.end], points[q.end]) > 0;
                      });
        }
    });
}

// The edge that ends in the direction of a greater row, and not beyond it, if there is one.
ConstrainedEdges::Edge ConstrainedEdges::edge_towards(Row from, Row to) const {
    const Edge *at = &edges_[first_[from]], *last = &edges_[first_[from + 1]];
    const auto turn = [&](const Edge& edge) {
        return edge.end == to
                   ? 0
                   : orient2d(mesh_.points[from], mesh_.points[edge.end], mesh_.points[to]);
    };
    if (last - at > static_cast<std::ptrdiff_t>(few))
        at = std::partition_point(at, last, [&](const Edge& edge) { return turn(edge) > 0; });
    else
        at = std::find_if(at, last, [&](const Edge& edge) { return turn(edge) == 0; });
    const bool leads =
        at != last && turn(*at) == 0 && !before_xy(mesh_.points[to], mesh_.points[at->end]);
    return leads ? *at : Edge{from, none};
}

std::uint32_t ConstrainedEdges::last_of_chain(std::uint32_t place) {
    while (chain_[place] != place) place = chain_[place] = chain_[chain_[place]];
    return place;
}

Row ConstrainedEdges::greater_end(std::uint32_t place) const {
    const HalfEdge edge = mesh_.half_edge(place / 3, static_cast<int>(place % 3));
    return before_xy(mesh_.points[edge.tail], mesh_.points[edge.head]) ? edge.head : edge.tail;
}

// A chain that goes on beyond the end passes through it: vertices within edges are found otherwise.
Row ConstrainedEdges::follow(Row from, Row to) {
    for (std::uint32_t before = none; from != to;) {
        const std::uint32_t place = edge_towards(from, to).place;
        if (place == none) break;
        marked_[place] = 1;
        if (chain_[place] == none) chain_[place] = place;
        if (before != none) chain_[before] = place;
        before = last_of_chain(place);
        from = greater_end(before);
        if (before_xy(mesh_.points[to], mesh_.points[from])) return to;
    }
    return from;
}

namespace {

std::vector<FollowedEdge> segments_of(const NamedMesh& named, const Constraints& constraints) {
    const auto named_row = [&](std::int32_t row) {
        return named.lowest.empty() ? static_cast<Row>(row) : named.lowest[static_cast<Row>(row)];
    };
    std::vector<FollowedEdge> segments(constraints.count);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Row from = named_row(constraints.ends[2 * i]);
        segments[i] = {from, named_row(constraints.ends[2 * i + 1]), from};
    }
    return segments;
}

// Follows the segments that are not whole.
bool follow(const NamedMesh& named, std::vector<FollowedEdge>& segments, ConstrainedEdges& edges) {
    const auto is_whole = [](const FollowedEdge& segment) { return segment.is_whole(); };
    if (std::all_of(segments.begin(), segments.end(), is_whole)) return true;
    const Point* const points = named.mesh.points;
    return edges.collect() &&
           for_each_in_blocks(segments.size(), named.pool.interrupt(), [&](std::size_t i) {
               auto& [from, to, reached] = segments[i];
               if (reached == to) return;
               if (before_xy(points[to], points[from])) std::swap(from, to);
               reached = edges.follow(from, to);
           });
}

}  // namespace

bool check_constraints(const NamedMesh& named, const Constraints& constraints, EdgePairing& pairing,
                       Flaws& flaws, std::optional<std::size_t>& outside) {
    ConstrainedEdges edges(named.mesh, named.pool);
    std::vector<FollowedEdge> segments = segments_of(named, constraints);
    if (!edges.match(segments) || !follow(named, segments, edges)) return false;
    if (!constraints.are_carved) {
        for (std::size_t i = 0; i < segments.size(); ++i)
            if (!segments[i].is_whole())
                flaws.add(Flaw::missing_constraints, {i, segments[i].reached});
    } else if (!pairing.triangles.any() && !check_carving(named, segments, edges, flaws, outside)) {
        return false;
    }
    std::erase_if(pairing.flippable, [&](const FlippableEdge& edge) {
        return edges.contain(edge.one) || edges.contain(edge.other);
    });
    return true;
}

}  // namespace liftmesh
