#include <thread>
#include <vector>

#include "bounded.hpp"
#include "checks.hpp"
#include "constrained/regions.hpp"
#include "patient.hpp"
#include "refinement/refine.hpp"
#include "verify/verify.hpp"

namespace parallel {

namespace {

using liftmesh::Constrained;
using liftmesh::Status;
using Rows = std::vector<std::int32_t>;

// Sides of a triangulation in a metric: they cross nowhere, and many are not Delaunay.
Rows stretched(const Cloud& cloud) {
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay({2, 0.5, 1.25}, cloud.input(), true, {}, never);
    Rows edges;
    for (std::size_t i = 0; i + 1 < 3 * found.result.triangle_count; i += 6)
        edges.insert(edges.end(), {found.result.simplices[i], found.result.simplices[i + 1]});
    return edges;
}

Constrained run(const Cloud& cloud, const Rows& edges, unsigned threads,
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

void verified(const Cloud& cloud, const Rows& edges, const Rows& corners, bool are_carved) {
    const liftmesh::Member member{liftmesh::Member::Kind::constrained,
                                  nullptr,
                                  {},
                                  {edges.data(), edges.size() / 2, are_carved}};
    const auto verdict = [&](unsigned threads, std::size_t patience) {
        Patient interrupt(patience);
        return liftmesh::verify(cloud.input(), corners.data(), corners.size() / 3, true, member, {},
                                {threads, false}, interrupt);
    };
    const liftmesh::Verdict alone = verdict(1, ~std::size_t{0}), many = verdict(4, ~std::size_t{0});
    demand(many.status == Status::ok && !many.flaws.any(), cloud,
           "the verifier finds flaws in triangles with constraints");
    demand(many.vertices == alone.vertices && many.outside == alone.outside &&
               many.interior_edges == alone.interior_edges,
           cloud, "threads change the verdict on constraints");
    for (const std::size_t patience : {1u, 3u, 8u, 20u}) verdict(3, patience);
}

void carved(const Cloud& cloud, const Rows& edges, const Constrained& found) {
    using namespace liftmesh::constrained;
    const Marked mesh{found.result.neighbors.get(), found.marks.data(),
                      found.result.triangle_count};
    const std::vector<std::uint8_t> all(found.pieces.size(), 1);
    const Rows none(2 * found.pieces.size());
    const std::int32_t* const simplices = found.result.simplices.get();
    const auto kept =
        carve(mesh, simplices, {found.pieces, all.data(), none.data()}, Carving::holes, {});
    demand(kept.size() == label(mesh).size(), cloud, "triangles are lost");
    Rows left;
    for (std::size_t t = 0; t < kept.size(); ++t)
        if (kept[t]) left.insert(left.end(), simplices + 3 * t, simplices + 3 * t + 3);
    verified(cloud, edges, {simplices, simplices + 3 * mesh.count}, false);
    if (!left.empty()) verified(cloud, edges, left, true);
}

// By callers at the same time, of whom one is interrupted.
void refined(const Cloud& cloud, const Rows& edges) {
    using namespace liftmesh::refinement;
    constexpr double cosine = 0.9;
    constexpr std::size_t forever = ~std::size_t{0}, patience[] = {forever, forever, 20};
    std::vector<Refined> found(std::size(patience));
    std::vector<std::thread> callers;
    for (std::size_t i = 0; i < found.size(); ++i)
        callers.emplace_back([&, i] {
            Constrained mesh = run(cloud, edges, 1);
            native::bound(mesh);
            const Rows labels = liftmesh::constrained::label(
                {mesh.result.neighbors.get(), mesh.marks.data(), mesh.result.triangle_count});
            Patient interrupt(patience[i]);
            const Wanted wanted{cosine, {}, {}, true, cloud.points.size() / 4, 2};
            found[i] = refine({cloud.input(), mesh, labels}, wanted, interrupt);
        });
    for (std::thread& caller : callers) caller.join();
    demand(found[0].status == Status::ok && found[0].added == found[1].added, cloud,
           "callers at the same time refine otherwise");
}

}  // namespace

void check_constraints(const Cloud& cloud) {
    const Rows edges = stretched(cloud);
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
    if (alone.status != Status::ok) return;
    carved(cloud, edges, alone);
    refined(cloud, edges);
}

}  // namespace parallel
