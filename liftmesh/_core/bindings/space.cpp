// Points in space: predicates, tetrahedra.

#include "bindings/python.hpp"
#include "predicates/insphere.hpp"
#include "tetrahedra/locate.hpp"
#include "tetrahedra/tetrahedra.hpp"
#include "verify/sphere.hpp"
#include "verify/tetrahedra.hpp"

namespace bindings {

namespace {

using liftmesh::SpacePoint;

SpacePoint place(const Places& places, std::size_t i) {
    const double* at = places.data() + 3 * i;
    return {at[0] + 0.0, at[1] + 0.0, at[2] + 0.0};
}

void orient3d(const Places& a, const Places& b, const Places& c, const Places& d,
              const Signs& signs) {
    fill(signs, [&](std::size_t i) {
        return liftmesh::volume_sign(place(a, i), place(b, i), place(c, i), place(d, i), {});
    });
}

void insphere(const Places& a, const Places& b, const Places& c, const Places& d, const Places& e,
              const Signs& signs, bool canonical) {
    const auto test = canonical ? liftmesh::insphere_canonical_exact : liftmesh::insphere_exact;
    fill(signs, [&](std::size_t i) {
        return test({place(a, i), place(b, i), place(c, i), place(d, i), place(e, i)},
                    liftmesh::Trust());
    });
}

nb::tuple tetrahedralize(const PlanarRows& rows, bool skip_non_finite, std::uint64_t secret,
                         unsigned threads, bool shared, nb::handle progress) {
    const Input input = read(rows);
    if (rows.shape(1) < 3) throw std::invalid_argument("rows need three columns");
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::tetrahedralize(input, skip_non_finite, secret, {threads, shared},
                                        interrupt);
    });
    raise_if(outcome.status == liftmesh::Status::interrupted);
    const nb::object simplices = adopt(std::move(outcome.simplices), outcome.count, 4);
    const nb::object neighbors = adopt(std::move(outcome.neighbors), outcome.count, 4);
    return nb::make_tuple(name(outcome.status), outcome.row, outcome.distinct, simplices, neighbors,
                          array_of<std::int32_t>(outcome.hull), duplicates(outcome.duplicates),
                          skipped(outcome.skipped), array_of<std::int32_t>(outcome.witness));
}

using Quadruples = Array<const std::int32_t, 4>;

// By a function that checks tetrahedra, or triangles on the sphere.
template <auto verify, int corners>
nb::tuple verified(const PlanarRows& rows, const Array<const std::int32_t, corners>& simplices,
                   bool skip_non_finite, unsigned threads, bool shared, nb::handle progress) {
    const Input input = read(rows);
    if (rows.shape(1) < 3) throw std::invalid_argument("rows need three columns");
    const auto verdict = unlocked(progress, [&](auto& interrupt) {
        return verify(input, simplices.data(), simplices.shape(0), skip_non_finite,
                      {threads, shared}, interrupt);
    });
    raise_if(verdict.status == liftmesh::Status::interrupted);
    return nb::make_tuple(name(verdict.status), verdict.row, verdict.skipped, verdict.vertices,
                          verdict.merged, verdict.facets, verdict.hull_facets,
                          as_list(verdict.flaws));
}

class PySpaceLocator {
 public:
    PySpaceLocator(Places rows, Quadruples simplices, Quadruples neighbors)
        : rows_(std::move(rows)),
          simplices_(std::move(simplices)),
          neighbors_(std::move(neighbors)),
          locator_({points(rows_), rows_.shape(0), simplices_.data(), neighbors_.data(),
                    simplices_.shape(0)}) {}

    void find(const Places& queries, const ChangingIds& found) const {
        run_unlocked([&](auto& interrupt) {
            return locator_.find(points(queries), queries.shape(0), interrupt, found.data());
        });
    }

 private:
    Places rows_;
    Quadruples simplices_, neighbors_;
    liftmesh::SpaceLocator locator_;
};

}  // namespace

void bind_space(nb::module_& m) {
    m.def("tetrahedralize", &tetrahedralize, "rows"_a, "skip_non_finite"_a, "secret"_a, "threads"_a,
          "shared"_a, "progress"_a.none());
    m.def("verify_tetrahedra", &verified<liftmesh::verify_tetrahedra, 4>, "rows"_a, "simplices"_a,
          "skip_non_finite"_a, "threads"_a, "shared"_a, "progress"_a.none());
    m.def("verify_sphere", &verified<liftmesh::verify_sphere, 3>, "rows"_a, "simplices"_a,
          "skip_non_finite"_a, "threads"_a, "shared"_a, "progress"_a.none());
    nb::class_<PySpaceLocator>(m, "SpaceLocator")
        .def(nb::init<Places, Quadruples, Quadruples>(), "points"_a, "simplices"_a, "neighbors"_a)
        .def("find", &PySpaceLocator::find, "queries"_a, "found"_a);
    m.def("orient3d", &orient3d, "a"_a, "b"_a, "c"_a, "d"_a, "signs"_a);
    m.def("insphere", &insphere, "a"_a, "b"_a, "c"_a, "d"_a, "e"_a, "signs"_a, "canonical"_a);
}

}  // namespace bindings
