// The Python interface of refinement.

#include "bindings/python.hpp"
#include "refinement/refine.hpp"

namespace bindings {

namespace {

using EdgeRows = Array<const std::int32_t, 2>;
using Bytes = Array<const std::uint8_t>;

// The arguments must fit each other: Python checks them.
liftmesh::Constrained whole(const Triples& simplices, const Triples& neighbors, const Ids& hull,
                            const Bytes& marks, const EdgeRows& pieces) {
    liftmesh::Constrained mesh;
    const std::size_t count = simplices.shape(0);
    mesh.result.make_room(count, hull.shape(0));
    std::copy_n(simplices.data(), 3 * count, mesh.result.simplices.get());
    std::copy_n(neighbors.data(), 3 * count, mesh.result.neighbors.get());
    std::copy_n(hull.data(), hull.shape(0), mesh.result.hull.get());
    mesh.marks.assign(marks.data(), marks.data() + count);
    const auto* first = reinterpret_cast<const liftmesh::constrained::Piece*>(pieces.data());
    mesh.pieces.assign(first, first + pieces.shape(0));
    return mesh;
}

// lengths(centroids, regions) returns as many.
liftmesh::refinement::Lengths asked(const nb::object& lengths) {
    if (lengths.is_none()) return {};
    return [&](std::span<const Point> centroids, std::span<const std::int32_t> regions,
               double* found) {
        const nb::gil_scoped_acquire gil;
        std::vector<double> places;
        for (const Point p : centroids) places.insert(places.end(), {p.x, p.y});
        std::vector<std::int32_t> numbers(regions.begin(), regions.end());
        const auto given =
            nb::cast<Array<const double>>(lengths(as_array(places), as_array(numbers)));
        if (given.shape(0) != centroids.size()) throw std::invalid_argument("lengths differ");
        std::copy_n(given.data(), centroids.size(), found);
    };
}

// The rows that were added and the pieces that they divide; triangles, neighbours and hull; of each
// triangle marks, region, cause and whether it is too large; and whether there was to be more.
nb::tuple refine(const PlanarRows& rows, const Triples& simplices, const Triples& neighbors,
                 const Ids& hull, const Bytes& marks, const EdgeRows& pieces, const Ids& regions,
                 double cosine, const Numbers& largest, const nb::object& lengths,
                 bool is_conforming, std::size_t most, std::size_t rounds, nb::handle progress) {
    using namespace liftmesh::refinement;
    if (marks.shape(0) != simplices.shape(0) || regions.shape(0) != simplices.shape(0) ||
        neighbors.shape(0) != simplices.shape(0))
        throw std::invalid_argument("lengths differ");
    liftmesh::Constrained mesh = whole(simplices, neighbors, hull, marks, pieces);
    const Start start{read(rows), mesh, {regions.data(), regions.shape(0)}};
    const Wanted wanted{
        cosine, {largest.data(), largest.shape(0)}, asked(lengths), is_conforming, most, rounds};
    Refined outcome =
        unlocked(progress, [&](auto& interrupt) { return refine(start, wanted, interrupt); });
    raise_if(outcome.status == liftmesh::Status::interrupted);
    const auto [triangles, beyond, around] = arrays(outcome.result);
    std::vector<std::uint8_t> causes;
    for (const Cause each : outcome.causes) causes.push_back(static_cast<std::uint8_t>(each));
    auto added = liftmesh::allocate<double>(2 * outcome.added.size());
    for (std::size_t i = 0; i < outcome.added.size(); ++i) {
        added[2 * i] = outcome.added[i].x;
        added[2 * i + 1] = outcome.added[i].y;
    }
    return nb::make_tuple(adopt(std::move(added), outcome.added.size(), 2),
                          as_array(outcome.divided), triangles, beyond, around,
                          as_array(outcome.marks), as_array(outcome.regions), as_array(causes),
                          as_array(outcome.is_large), outcome.is_capped);
}

}  // namespace

void bind_refinement(nb::module_& m) {
    m.def("refine", &refine, "rows"_a, "simplices"_a, "neighbors"_a, "hull"_a, "marks"_a,
          "pieces"_a, "regions"_a, "cosine"_a, "largest"_a, "lengths"_a.none(), "conforming"_a,
          "most"_a, "rounds"_a, "progress"_a.none());
}

}  // namespace bindings
