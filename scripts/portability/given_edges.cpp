#include <cmath>
#include <limits>
#include <vector>

#include "bounded.hpp"
#include "constrained/regions.hpp"
#include "kinds.hpp"
#include "predicates/crossings.hpp"
#include "refinement/refine.hpp"
#include "rows.hpp"
#include "verify/verify.hpp"

namespace portability {

namespace {

using liftmesh::Constrained;
using liftmesh::Status;
using Rows = std::vector<std::int32_t>;

// Sides of a triangulation in a metric: they cross nowhere, and many are not Delaunay.
Rows stretched(const liftmesh::Input& input) {
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay({2, 0.5, 1.25}, input, true, {}, never);
    Rows edges;
    for (std::size_t i = 0; i + 1 < 3 * found.result.triangle_count; i += 6)
        edges.insert(edges.end(), {found.result.simplices[i], found.result.simplices[i + 1]});
    return edges;
}

template <class Value>
void add_all(Digest& digest, const std::vector<Value>& values) {
    if (!values.empty()) digest.add(values.data(), values.size() * sizeof(Value));
}

void add(Digest& digest, const Constrained& found) {
    digest.add(found.status);
    const std::size_t corners = 3 * found.result.triangle_count;
    if (corners > 0) {
        digest.add(found.result.simplices.get(), corners * sizeof(std::int32_t));
        digest.add(found.result.neighbors.get(), corners * sizeof(std::int32_t));
    }
    add_all(digest, found.marks);
    add_all(digest, found.pieces);
    add_all(digest, found.members);
    add_all(digest, found.crossings);
}

void add_verdict(Digest& digest, const liftmesh::Input& input, const Rows& edges,
                 const Rows& corners, bool are_carved) {
    liftmesh::NoInterrupt never;
    const liftmesh::Member member{liftmesh::Member::Kind::constrained,
                                  nullptr,
                                  {},
                                  {edges.data(), edges.size() / 2, are_carved}};
    const liftmesh::Verdict found =
        liftmesh::verify(input, corners.data(), corners.size() / 3, true, member, {}, {}, never);
    digest.add(found.flaws.any());
    for (const std::size_t count : {found.vertices, found.merged, found.interior_edges,
                                    found.boundary_edges, found.outside.value_or(0)})
        digest.add(std::uint64_t{count});
}

void add_regions(Digests& digests, const liftmesh::Input& input, const Rows& edges,
                 const Constrained& found) {
    using namespace liftmesh::constrained;
    const Marked mesh{found.result.neighbors.get(), found.marks.data(),
                      found.result.triangle_count};
    const std::vector<std::uint8_t> all(found.pieces.size(), 1);
    const Rows none(2 * found.pieces.size());
    const std::int32_t* const simplices = found.result.simplices.get();
    const auto kept =
        carve(mesh, simplices, {found.pieces, all.data(), none.data()}, Carving::holes, {});
    add_all(digests.of["regions"], label(mesh));
    add_all(digests.of["regions"], kept);
    Rows left;
    for (std::size_t t = 0; t < kept.size(); ++t)
        if (kept[t]) left.insert(left.end(), simplices + 3 * t, simplices + 3 * t + 3);
    Digest& verdicts = digests.of["verdicts on constraints"];
    add_verdict(verdicts, input, edges, {simplices, simplices + 3 * mesh.count}, false);
    add_verdict(verdicts, input, edges, left, true);
}

// What is between every second pair of constraints stays as it is.
void add_refined(Digest& digest, const liftmesh::Input& input, Constrained& mesh,
                 bool is_conforming) {
    using namespace liftmesh::refinement;
    constexpr double cosine = 0.8660254037844387;  // of 30 degrees
    Rows labels = liftmesh::constrained::label(
        {mesh.result.neighbors.get(), mesh.marks.data(), mesh.result.triangle_count});
    for (std::int32_t& label : labels) label = label % 2 == 0 ? label : -1;
    liftmesh::NoInterrupt never;
    const Refined found =
        refine({input, mesh, labels}, {cosine, {}, {}, is_conforming, input.rows, 2}, never);
    digest.add(found.result.simplices.get(),
               3 * found.result.triangle_count * sizeof(std::int32_t));
    add_all(digest, found.added);
    add_all(digest, found.divided);
    add_all(digest, found.marks);
    add_all(digest, found.regions);
    add_all(digest, found.causes);
}

}  // namespace

void add_constraints(const double* coordinates, std::size_t rows, Digests& digests) {
    const liftmesh::Input input = native::input_of(coordinates, rows);
    liftmesh::NoInterrupt never;
    Rows edges = stretched(input);
    const auto run = [&] {
        return liftmesh::constrained_delaunay(input, edges.data(), edges.size() / 2, true, {},
                                              never);
    };
    Constrained found = run();
    add(digests.of["constrained"], found);
    if (found.status != Status::ok) return;
    add_regions(digests, input, edges, found);
    native::bound(found);
    for (const bool is_conforming : {false, true})
        add_refined(digests.of["refined"], input, found, is_conforming);
    for (std::int32_t i = 0; i < 8; ++i)  // some that cross
        edges.push_back(i * 7 % static_cast<std::int32_t>(rows));
    const Constrained crossed = run();
    add(digests.of["constrained"], crossed);
    std::vector<double> pairs, places(2 * crossed.crossings.size());
    for (const auto [one, other] : crossed.crossings)
        for (const std::size_t end : {2 * one, 2 * one + 1, 2 * other, 2 * other + 1}) {
            const liftmesh::Point p = input[static_cast<std::size_t>(edges[end])];
            pairs.insert(pairs.end(), {p.x, p.y});
        }
    liftmesh::find_crossings(pairs.data(), places.size() / 2, places.data());
    for (double& place : places)
        if (std::isnan(place)) place = std::numeric_limits<double>::quiet_NaN();
    add_all(digests.of["crossings"], places);
}

}  // namespace portability
