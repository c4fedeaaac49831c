// Points on the sphere.

#include "sphere/sphere.hpp"

#include "bindings/python.hpp"

namespace bindings {

namespace {

nb::tuple spherical_delaunay(const PlanarRows& rows, bool skip_non_finite, std::uint64_t secret,
                             nb::handle progress) {
    const Input input = read(rows);
    if (rows.shape(1) < 3) throw std::invalid_argument("rows need three columns");
    const auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::triangulate_sphere(input, skip_non_finite, secret, interrupt);
    });
    raise_if(outcome.status == liftmesh::Status::interrupted);
    return nb::make_tuple(name(outcome.status), outcome.row, outcome.distinct,
                          array_of<std::int32_t>(outcome.simplices),
                          array_of<std::int32_t>(outcome.neighbors), duplicates(outcome.duplicates),
                          skipped(outcome.skipped));
}

void circle_centres(const Places& places, const Triples& simplices, const ChangingPlaces& centres) {
    run_unlocked([&](auto& interrupt) {
        return liftmesh::find_circle_centres(
            points(places), simplices.data(), simplices.shape(0), interrupt,
            reinterpret_cast<liftmesh::SpacePoint*>(centres.data()));
    });
}

nb::tuple sphere_cells(const Triples& simplices, const Triples& neighbors, std::size_t rows) {
    liftmesh::SphereCells cells;
    run_unlocked([&](auto& interrupt) {
        return liftmesh::find_sphere_cells(simplices.data(), neighbors.data(), simplices.shape(0),
                                           rows, interrupt, cells);
    });
    return nb::make_tuple(as_array(cells.starts), as_array(cells.facets));
}

}  // namespace

void bind_sphere(nb::module_& m) {
    m.def("spherical_delaunay", &spherical_delaunay, "rows"_a, "skip_non_finite"_a, "secret"_a,
          "progress"_a.none());
    m.def("circle_centres", &circle_centres, "points"_a, "simplices"_a, "centres"_a);
    m.def("sphere_cells", &sphere_cells, "simplices"_a, "neighbors"_a, "rows"_a);
}

}  // namespace bindings
