// A constraint is followed from its lesser end, by x, then y: the next edge is the one whose head
// lies exactly in the direction of the other end. Each edge is listed at its lesser end, so those
// of one vertex lie within half a turn, and orientations alone sort them by direction: many are
// sorted once, and searched. Constraints may lie on top of each other: edges that one has followed
// are linked to chains, and another one goes to the end of a chain at once, by union-find. So all
// of it takes O(n log n), but for the constraints themselves.

#include "verify/constraints.hpp"

#include "parallel/blocks.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t few = 24;  // edges of a vertex, which are not sorted

}  // namespace

// The greater end of the edge opposite a corner.
Row ConstrainedEdges::ends_at(std::uint32_t place) const {
    const HalfEdge edge = mesh_.half_edge(place / 3, static_cast<int>(place % 3));
    return before_xy(mesh_.points[edge.tail], mesh_.points[edge.head]) ? edge.head : edge.tail;
}

bool ConstrainedEdges::collect(ThreadPool& pool) {
    const auto for_each_edge = [&](auto visit) {
        return for_each_in_blocks(3 * mesh_.count, pool.interrupt(), [&](std::size_t place) {
            const HalfEdge edge = mesh_.half_edge(place / 3, static_cast<int>(place % 3));
            if (edge.tail == edge.head) return;
            const bool ascends = before_xy(mesh_.points[edge.tail], mesh_.points[edge.head]);
            visit(ascends ? edge.tail : edge.head, static_cast<std::uint32_t>(place));
        });
    };
    first_.assign(mesh_.rows + 1, 0);
    if (!for_each_edge([&](Row row, auto) { ++first_[row]; })) return false;
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    edges_ = allocate<std::uint32_t>(3 * mesh_.count);
    if (!for_each_edge([&](Row row, std::uint32_t place) { edges_[--first_[row]] = place; }))
        return false;
    chain_.assign(3 * mesh_.count, none);
    return in_blocks(mesh_.rows, block, pool, [&](std::size_t row, std::size_t last, auto) {
        for (; row < last; ++row) {
            if (first_[row + 1] - first_[row] <= few) continue;
            const Point* points = mesh_.points;
            std::sort(&edges_[first_[row]], &edges_[first_[row + 1]], [&](auto p, auto q) {
                return orient2d(points[row], points[ends_at(p)], points[ends_at(q)]) > 0;
            });
        }
    });
}

// An edge whose head lies in the direction of a greater row, and not beyond it; or none.
std::uint32_t ConstrainedEdges::edge_towards(Row from, Row to) const {
    const std::uint32_t *at = &edges_[first_[from]], *last = &edges_[first_[from + 1]];
    const auto turn = [&](std::uint32_t place) {
        const Row head = ends_at(place);
        return head == to ? 0 : orient2d(mesh_.points[from], mesh_.points[head], mesh_.points[to]);
    };
    if (last - at > static_cast<std::ptrdiff_t>(few))
        at = std::partition_point(at, last, [&](std::uint32_t place) { return turn(place) > 0; });
    else
        at = std::find_if(at, last, [&](std::uint32_t place) { return turn(place) == 0; });
    const bool leads = at != last && turn(*at) == 0;
    return leads && !before_xy(mesh_.points[to], mesh_.points[ends_at(*at)]) ? *at : none;
}

std::uint32_t ConstrainedEdges::last_of_chain(std::uint32_t place) {
    while (chain_[place] != place) place = chain_[place] = chain_[chain_[place]];
    return place;
}

// A chain that goes on beyond the end passes through it: vertices within edges are found otherwise.
Row ConstrainedEdges::follow(Row from, Row to) {
    for (std::uint32_t before = none; from != to;) {
        const std::uint32_t place = edge_towards(from, to);
        if (place == none) break;
        if (chain_[place] == none) chain_[place] = place;
        if (before != none) chain_[before] = place;
        before = last_of_chain(place);
        from = ends_at(before);
        if (before_xy(mesh_.points[to], mesh_.points[from])) return to;
    }
    return from;
}

namespace {

// Those of positive length.
std::vector<Segment> segments_of(const NamedMesh& named, const Constraints& constraints) {
    std::vector<Segment> segments(constraints.count);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        Row a = named.lowest[static_cast<Row>(constraints.ends[2 * i])];
        Row b = named.lowest[static_cast<Row>(constraints.ends[2 * i + 1])];
        if (before_xy(named.mesh.points[b], named.mesh.points[a])) std::swap(a, b);
        segments[i] = {a, b, a};
    }
    return segments;
}

}  // namespace

bool check_constraints(const NamedMesh& named, const Constraints& constraints, EdgePairing& pairing,
                       Flaws& flaws, std::optional<std::size_t>& outside) {
    Interrupt& interrupt = named.pool.interrupt();
    ConstrainedEdges edges(named.mesh);
    std::vector<Segment> segments = segments_of(named, constraints);
    const auto follow = [&](std::size_t i) {
        segments[i].reached = edges.follow(segments[i].from, segments[i].to);
        if (!constraints.are_carved && segments[i].reached != segments[i].to)
            flaws.add(Flaw::missing_constraints, {i, segments[i].reached});
    };
    if (!edges.collect(named.pool) || !for_each_in_blocks(segments.size(), interrupt, follow))
        return false;
    if (constraints.are_carved && !pairing.triangles.any() &&
        !check_carving(named, segments, edges, flaws, outside))
        return false;
    std::erase_if(pairing.flippable, [&](const FlippableEdge& edge) {
        return edges.contain(edge.one) || edges.contain(edge.other);
    });
    return true;
}

}  // namespace liftmesh
