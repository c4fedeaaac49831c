#include <vector>

#include "checks.hpp"
#include "constrained/regions.hpp"
#include "patient.hpp"

namespace parallel {

namespace {

using liftmesh::Constrained;
using liftmesh::Status;

// Sides of a triangulation in a metric: they cross nowhere, and many are not Delaunay.
std::vector<std::int32_t> stretched(const Cloud& cloud) {
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay({2, 0.5, 1.25}, cloud.input(), true, {}, never);
    std::vector<std::int32_t> edges;
    for (std::size_t i = 0; i + 1 < 3 * found.result.triangle_count; i += 6)
        edges.insert(edges.end(), {found.result.simplices[i], found.result.simplices[i + 1]});
    return edges;
}

Constrained run(const Cloud& cloud, const std::vector<std::int32_t>& edges, unsigned threads,
                std::size_t patience = ~std::size_t{0}) {
    Patient interrupt(patience);
    return liftmesh::constrained_delaunay(cloud.input(), edges.data(), edges.size() / 2, true,
                                          {threads, false}, interrupt);
}

bool same(const Constrained& a, const Constrained& b) {
    const std::size_t count = 3 * a.result.triangle_count;
    return a.status == b.status && a.result.triangle_count == b.result.triangle_count &&
           std::equal(a.result.simplices.get(), a.result.simplices.get() + count,
                      b.result.simplices.get()) &&
           std::equal(a.result.neighbors.get(), a.result.neighbors.get() + count,
                      b.result.neighbors.get()) &&
           a.marks == b.marks && a.pieces == b.pieces && a.members == b.members;
}

void carved(const Cloud& cloud, const Constrained& found) {
    using namespace liftmesh::constrained;
    const Marked mesh{found.result.neighbors.get(), found.marks.data(),
                      found.result.triangle_count};
    const std::vector<std::uint8_t> all(found.pieces.size(), 1);
    const std::vector<std::int32_t> none(found.pieces.size());
    const auto kept = carve(mesh, found.result.simplices.get(),
                            {found.pieces, all.data(), none.data()}, Carving::holes, {});
    demand(kept.size() == label(mesh).size(), cloud, "triangles are lost");
}

}  // namespace

void check_constraints(const Cloud& cloud) {
    const std::vector<std::int32_t> edges = stretched(cloud);
    const Constrained alone = run(cloud, edges, 1);
    demand(alone.crossings.empty() && alone.pieces.size() <= edges.size() / 2, cloud,
           "edges cross, or are split");
    for (const unsigned threads : {2u, 5u})
        demand(same(run(cloud, edges, threads), alone), cloud, "threads change constraints");
    for (const std::size_t patience : {1u, 3u, 9u, 30u, 90u}) {
        const Constrained found = run(cloud, edges, 4, patience);
        demand(found.status == Status::interrupted || same(found, alone), cloud,
               "a run that could be interrupted puts edges in otherwise");
    }
    if (alone.status == Status::ok) carved(cloud, alone);
}

}  // namespace parallel
