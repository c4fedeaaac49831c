// Points in space: predicates, tetrahedra.

#include "bindings/python.hpp"
#include "predicates/insphere.hpp"

namespace bindings {

namespace {

using liftmesh::SpacePoint;
using Places = Array<const double, 3>;

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
                    liftmesh::Guard::anywhere());
    });
}

}  // namespace

void bind_space(nb::module_& m) {
    m.def("orient3d", &orient3d, "a"_a, "b"_a, "c"_a, "d"_a, "signs"_a);
    m.def("insphere", &insphere, "a"_a, "b"_a, "c"_a, "d"_a, "e"_a, "signs"_a, "canonical"_a);
}

}  // namespace bindings
