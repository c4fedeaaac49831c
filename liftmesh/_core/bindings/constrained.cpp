// The Python interface of constrained triangulations.

#include "constrained/constrained.hpp"

#include "bindings/python.hpp"
#include "constrained/regions.hpp"
#include "predicates/crossings.hpp"

namespace bindings {

namespace {

using EdgeRows = Array<const std::int32_t, 2>;
using Bytes = Array<const std::uint8_t>;

nb::tuple constrained(const PlanarRows& rows, const EdgeRows& edges, bool skip_non_finite,
                      unsigned threads, bool shared, nb::handle progress) {
    const Input input = read(rows);
    const std::size_t count = edges.shape(0);
    if (std::any_of(edges.data(), edges.data() + 2 * count, [&](std::int32_t row) {
            return row < 0 || static_cast<std::size_t>(row) >= input.rows;
        }))
        throw std::invalid_argument("an end is no row");
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::constrained_delaunay(input, edges.data(), count, skip_non_finite,
                                              {threads, shared}, interrupt);
    });
    const nb::tuple found = as_tuple(outcome);  // first: it raises after an interrupt
    return nb::make_tuple(
        found, as_array(outcome.marks), array_of<std::int32_t>(outcome.pieces),
        array_of<std::int32_t>(outcome.starts), array_of<std::int32_t>(outcome.members),
        array_of<std::int32_t>(outcome.zero_length), array_of<std::int32_t>(outcome.unplaced),
        array_of<std::int32_t>(outcome.crossings));
}

// The arguments of both functions must fit each other: Python checks them.
liftmesh::constrained::Marked marked(const Triples& neighbors, const Bytes& marks) {
    if (neighbors.shape(0) != marks.shape(0)) throw std::invalid_argument("lengths differ");
    return {neighbors.data(), marks.data(), marks.shape(0)};
}

nb::object label_regions(const Triples& neighbors, const Bytes& marks) {
    const auto mesh = marked(neighbors, marks);
    return as_array(
        unlocked(nb::none(), [&](auto&) { return liftmesh::constrained::label(mesh); }));
}

nb::object carve(const Triples& simplices, const Triples& neighbors, const Bytes& marks,
                 const EdgeRows& pieces, const Bytes& bounds, const EdgeRows& winding,
                 std::string_view carving, const Ids& seeds) {
    using namespace liftmesh::constrained;
    const Marked mesh = marked(neighbors, marks);
    const std::size_t count = pieces.shape(0);
    const bool fits =
        simplices.shape(0) == mesh.count && bounds.shape(0) == count && winding.shape(0) == count;
    if (!fits) throw std::invalid_argument("lengths differ");
    const std::span<const Piece> in_order(reinterpret_cast<const Piece*>(pieces.data()), count);
    const Carving way = carving == "holes"     ? Carving::holes
                        : carving == "outside" ? Carving::outside
                                               : Carving::none;
    return as_array(unlocked(nb::none(), [&](auto&) {
        return liftmesh::constrained::carve(mesh, simplices.data(),
                                            {in_order, bounds.data(), winding.data()}, way,
                                            {seeds.data(), seeds.shape(0)});
    }));
}

void crossing_places(const Array<const double, 8>& pairs, const Array<double, 2>& places) {
    if (pairs.shape(0) != places.shape(0)) throw std::invalid_argument("lengths differ");
    liftmesh::find_crossings(pairs.data(), pairs.shape(0), places.data());
}

void distances(const Array<const double, 6>& edges_and_points, const Array<double>& found) {
    if (edges_and_points.shape(0) != found.shape(0)) throw std::invalid_argument("lengths differ");
    liftmesh::find_distances(edges_and_points.data(), found.shape(0), found.data());
}

}  // namespace

void bind_constrained(nb::module_& m) {
    m.def("constrained", &constrained, "rows"_a, "edges"_a, "skip_non_finite"_a, "threads"_a,
          "shared"_a, "progress"_a.none());
    m.def("carve", &carve, "simplices"_a, "neighbors"_a, "constrained"_a, "pieces"_a, "bounds"_a,
          "winding"_a, "carving"_a, "seeds"_a);
    m.def("crossing_places", &crossing_places, "pairs"_a, "places"_a);
    m.def("distances", &distances, "edges_and_points"_a, "found"_a);
    m.def("label_regions", &label_regions, "neighbors"_a, "constrained"_a);
}

}  // namespace bindings
