#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "predicates/scale.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/flaws.hpp"
#include "verify/verify.hpp"

namespace liftmesh {

namespace {

// Copies the points, unscaled: the exact predicates take any, and only the filters are lost where
// coordinates are very small or large.
Guard read_points(const Input& rows, Point* points) {
    Range range;
    for (std::size_t row = 0; row < rows.rows; ++row) range.add(points[row] = rows[row]);
    return Scale(range).moves ? Guard::anywhere() : Scale(range).guard;
}

void add_flippable(const std::vector<FlippableEdge>& edges, Flaws& flaws) {
    for (const FlippableEdge& edge : edges) {
        const auto [low, high] = std::minmax({edge.one, edge.other});
        if (edge.not_delaunay) flaws.add(Flaw::not_delaunay, {low, high});
        flaws.add(Flaw::not_canonical, {low, high});
    }
}

}  // namespace

VerifiedPart verify_part(const Input& rows, const std::int32_t* simplices, std::size_t count,
                         Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(std::max(rows.rows, count)), interrupt);
    const Buffer<Point> points = allocate<Point>(rows.rows);
    const Guard guard = read_points(rows, points.get());
    MeshView mesh{points.get(), rows.rows, simplices, count, guard};
    mesh.finite = true;
    EdgePairing pairing;
    VerifiedPart part;
    part.is_complete = pair_edges(mesh, pool, pairing);
    part.flaws = std::move(pairing.triangles);
    add_flippable(pairing.flippable, part.flaws);
    part.interior_edges = pairing.interior_edges;
    part.open.reserve(pairing.boundary.size());
    for (const HalfEdge& edge : pairing.boundary)
        part.open.push_back({static_cast<std::int32_t>(edge.tail),
                             static_cast<std::int32_t>(edge.head), simplices[edge.place]});
    return part;
}

}  // namespace liftmesh
