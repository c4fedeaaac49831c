// The Python interface of stars in metrics of their own.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>

#include "anisotropic/stars.hpp"
#include "bindings_runs.hpp"

namespace bindings {

using namespace nb::literals;

namespace {

using liftmesh::anisotropic::Metric;
using Matrices = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const std::int32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using RowPairs = nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

nb::tuple anisotropic_stars(const Pairs& points, const Matrices& metrics, const Numbers& starts,
                            const Numbers& neighbors, const RowPairs& hull, nb::handle progress) {
    static_assert(sizeof(Point) == 2 * sizeof(double) && sizeof(Metric) == 3 * sizeof(double));
    const liftmesh::anisotropic::Given given{
        {reinterpret_cast<const Point*>(points.data()), points.shape(0)},
        {reinterpret_cast<const Metric*>(metrics.data()), metrics.shape(0)},
        {starts.data(), starts.shape(0)},
        {neighbors.data(), neighbors.shape(0)},
        {hull.data(), 2 * hull.shape(0)}};
    PythonInterrupt interrupt(progress);
    liftmesh::anisotropic::Lists found;
    bool done = false;
    {
        const nb::gil_scoped_release unlocked;
        const liftmesh::IeeeArithmetic ieee;
        done = liftmesh::anisotropic::stars(given, interrupt, found);
    }
    if (!done) throw nb::python_error();
    return nb::make_tuple(as_array(found.starts), as_array(found.rows));
}

}  // namespace

void bind_anisotropic(nb::module_& m) {
    m.def("anisotropic_stars", &anisotropic_stars, "points"_a, "metrics"_a, "starts"_a,
          "neighbors"_a, "hull"_a, "progress"_a.none());
}

}  // namespace bindings
