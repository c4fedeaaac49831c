// Alpha complexes and shapes, radii of circumscribed spheres.

#include "alpha/alpha.hpp"

#include "bindings/python.hpp"

namespace bindings {

namespace {

using liftmesh::SimplexView;
using Simplices = nb::ndarray<const std::int32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Radii = Array<double>;

// Calls work.operator()<K>() for simplices of K corners: triangles or tetrahedra.
template <class Work>
auto for_corners(const Simplices& simplices, Work work) {
    if (simplices.shape(1) != 3 && simplices.shape(1) != 4)
        throw std::invalid_argument("simplices need three or four columns");
    return simplices.shape(1) == 3 ? work.template operator()<3>() : work.template operator()<4>();
}

// One number is written or read for each simplex.
void check_length(std::size_t length, const Simplices& simplices) {
    if (length != simplices.shape(0)) throw std::invalid_argument("there is one for each simplex");
}

template <int K>
SimplexView<K> simplex_view(const Places& places, const Simplices& simplices,
                            const Simplices& neighbors) {
    return {points(places), simplices.data(), neighbors.data(), simplices.shape(0)};
}

void circumradii(const Places& places, const Simplices& simplices, bool up, const Radii& radii) {
    check_length(radii.shape(0), simplices);
    const auto rounding = up ? liftmesh::RadiusRounding::up : liftmesh::RadiusRounding::nearest;
    run_unlocked([&](auto& interrupt) {
        return for_corners(simplices, [&]<int K>() {
            return liftmesh::circumradii<K>(points(places), simplices.data(), simplices.shape(0),
                                            rounding, interrupt, radii.data());
        });
    });
}

template <int K>
nb::tuple tuple_of(const liftmesh::AlphaFaces<K>& faces) {
    return nb::make_tuple(array_of<std::int32_t>(faces.corners), as_array(faces.radii));
}

nb::tuple alpha_filtration(const Places& places, const Simplices& simplices,
                           const Simplices& neighbors, const Numbers& radii) {
    check_length(radii.shape(0), simplices);
    check_length(neighbors.shape(0), simplices);
    return for_corners(simplices, [&]<int K>() {
        liftmesh::AlphaFiltration<K> found;
        run_unlocked([&](auto& interrupt) {
            return liftmesh::find_alpha_filtration(simplex_view<K>(places, simplices, neighbors),
                                                   radii.data(), interrupt, found);
        });
        return nb::make_tuple(tuple_of(found.facets), tuple_of(found.edges));
    });
}

nb::tuple alpha_surface(const Places& places, const Simplices& simplices,
                        const Simplices& neighbors, double alpha, const ChangingFlags& is_inside) {
    check_length(is_inside.shape(0), simplices);
    check_length(neighbors.shape(0), simplices);
    return for_corners(simplices, [&]<int K>() {
        liftmesh::AlphaSurface<K> surface;
        run_unlocked([&](auto& interrupt) {
            return liftmesh::find_alpha_surface<K>(simplex_view<K>(places, simplices, neighbors),
                                                   alpha, interrupt, is_inside.data(), surface);
        });
        return nb::make_tuple(array_of<std::int32_t>(surface.facets),
                              array_of<std::int32_t>(surface.singular));
    });
}

double solid_alpha(const Simplices& simplices, const Simplices& neighbors, std::size_t rows,
                   const Numbers& radii, std::size_t components) {
    check_length(radii.shape(0), simplices);
    check_length(neighbors.shape(0), simplices);
    const double alpha = unlocked(nb::none(), [&](auto& interrupt) {
        return liftmesh::solid_alpha(simplices.data(), neighbors.data(), simplices.shape(0),
                                     simplices.shape(1), rows, radii.data(), components, interrupt);
    });
    raise_if(std::isnan(alpha));
    return alpha;
}

}  // namespace

void bind_alpha(nb::module_& m) {
    m.def("circumradii", &circumradii, "points"_a, "simplices"_a, "up"_a, "radii"_a);
    m.def("alpha_filtration", &alpha_filtration, "points"_a, "simplices"_a, "neighbors"_a,
          "radii"_a);
    m.def("alpha_surface", &alpha_surface, "points"_a, "simplices"_a, "neighbors"_a, "alpha"_a,
          "is_inside"_a);
    m.def("solid_alpha", &solid_alpha, "simplices"_a, "neighbors"_a, "rows"_a, "radii"_a,
          "components"_a);
}

}  // namespace bindings
