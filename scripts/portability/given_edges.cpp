#include <cmath>
#include <limits>
#include <vector>

#include "constrained/places.hpp"
#include "constrained/regions.hpp"
#include "kinds.hpp"
#include "rows.hpp"

namespace portability {

namespace {

using liftmesh::Constrained;
using liftmesh::Status;

// Sides of a triangulation in a metric: they cross nowhere, and many are not Delaunay.
std::vector<std::int32_t> stretched(const liftmesh::Input& input) {
    liftmesh::NoInterrupt never;
    const auto found = liftmesh::delaunay({2, 0.5, 1.25}, input, true, {}, never);
    std::vector<std::int32_t> edges;
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

void add_regions(Digest& digest, const Constrained& found) {
    using namespace liftmesh::constrained;
    const Marked mesh{found.result.neighbors.get(), found.marks.data(),
                      found.result.triangle_count};
    const std::vector<std::uint8_t> all(found.pieces.size(), 1);
    const std::vector<std::int32_t> none(found.pieces.size());
    add_all(digest, label(mesh));
    add_all(digest, carve(mesh, found.result.simplices.get(),
                          {found.pieces, all.data(), none.data()}, Carving::holes, {}));
}

}  // namespace

void add_constraints(const double* coordinates, std::size_t rows, Digests& digests) {
    const liftmesh::Input input = native::input_of(coordinates, rows);
    liftmesh::NoInterrupt never;
    std::vector<std::int32_t> edges = stretched(input);
    const auto run = [&] {
        return liftmesh::constrained_delaunay(input, edges.data(), edges.size() / 2, true, {},
                                              never);
    };
    const Constrained found = run();
    add(digests.of["constrained"], found);
    if (found.status != Status::ok) return;
    add_regions(digests.of["regions"], found);
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
    liftmesh::constrained::find_crossings(pairs.data(), places.size() / 2, places.data());
    for (double& place : places)
        if (std::isnan(place)) place = std::numeric_limits<double>::quiet_NaN();
    add_all(digests.of["crossings"], places);
}

}  // namespace portability
