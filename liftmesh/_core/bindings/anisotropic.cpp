// The Python interface of stars in metrics of their own.

#include "anisotropic/stars.hpp"
#include "bindings/python.hpp"

namespace bindings {

namespace {

using liftmesh::anisotropic::Metric;
using Matrices = Array<const double, 3>;
using RowPairs = Array<const std::int32_t, 2>;

nb::tuple anisotropic_stars(const Pairs& points, const Matrices& metrics, const Ids& starts,
                            const Ids& neighbors, const RowPairs& hull, nb::handle progress) {
    static_assert(sizeof(Point) == 2 * sizeof(double) && sizeof(Metric) == 3 * sizeof(double));
    const liftmesh::anisotropic::Given given{
        {reinterpret_cast<const Point*>(points.data()), points.shape(0)},
        {reinterpret_cast<const Metric*>(metrics.data()), metrics.shape(0)},
        {starts.data(), starts.shape(0)},
        {neighbors.data(), neighbors.shape(0)},
        {hull.data(), 2 * hull.shape(0)}};
    liftmesh::anisotropic::Lists found;
    run_unlocked(
        [&](auto& interrupt) { return liftmesh::anisotropic::stars(given, interrupt, found); },
        progress);
    return nb::make_tuple(as_array(found.starts), as_array(found.rows));
}

}  // namespace

void bind_anisotropic(nb::module_& m) {
    m.def("anisotropic_stars", &anisotropic_stars, "points"_a, "metrics"_a, "starts"_a,
          "neighbors"_a, "hull"_a, "progress"_a.none());
}

}  // namespace bindings
