// The Python interface of points that are lifted by weights, radii or a metric.

#include "bindings/python.hpp"
#include "delaunay/delaunay.hpp"
#include "predicates/lifted_side.hpp"

namespace bindings {

namespace {

using Values = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// Row i of the values belongs to the points i, column k to the k-th of them.
template <class Lift>
liftmesh::Lifted<Lift> site(const Pairs& points, const Values& values, std::size_t i,
                            std::size_t k) {
    if constexpr (std::is_same_v<Lift, liftmesh::ByMetric>)
        return {point(points, i), {}};
    else
        return {point(points, i), values.data()[i * values.shape(1) + k]};
}

// Calls work(lift) with the lift of a name; the values are those of the sites, or a metric.
template <class Work>
void with_lift(std::string_view name, const Values& values, Work work) {
    const double* v = values.data();
    if (name == "weights") return work(liftmesh::ByWeight{});
    if (name == "radii") return work(liftmesh::ByRadius{});
    if (name == "metric") return work(liftmesh::ByMetric{v[0], v[1], v[2]});
    throw std::invalid_argument("unknown lift");
}

void lifted_side(const Pairs& a, const Pairs& b, const Pairs& c, const Pairs& d,
                 const Values& values, std::string_view lift, const Signs& signs, bool canonical) {
    with_lift(lift, values, [&]<class Lift>(const Lift& by) {
        const auto test = canonical ? liftmesh::lifted_side_canonical_exact<Lift>
                                    : liftmesh::lifted_side_exact<Lift>;
        fill(signs, [&](std::size_t i) {
            return test(by, site<Lift>(a, values, i, 0), site<Lift>(b, values, i, 1),
                        site<Lift>(c, values, i, 2), site<Lift>(d, values, i, 3),
                        liftmesh::Guard::anywhere());
        });
    });
}

void height_between(const Pairs& a, const Pairs& b, const Pairs& c, const Values& values,
                    std::string_view lift, const Signs& signs) {
    with_lift(lift, values, [&]<class Lift>(const Lift& by) {
        fill(signs, [&](std::size_t i) {
            return liftmesh::height_between(by, site<Lift>(a, values, i, 0),
                                            site<Lift>(b, values, i, 1),
                                            site<Lift>(c, values, i, 2));
        });
    });
}

nb::tuple regular(const PlanarRows& rows, const Column& values, bool are_radii,
                  bool skip_non_finite, unsigned threads, bool shared, nb::handle progress) {
    const Input input = read(rows);
    const bool single = values.dtype() == nb::dtype<float>();
    if (!single && values.dtype() != nb::dtype<double>())
        throw std::invalid_argument("values must be float64 or float32");
    if (values.shape(0) != input.rows) throw std::invalid_argument("lengths differ");
    const auto stride = values.stride(0) * static_cast<std::ptrdiff_t>(values.itemsize());
    const liftmesh::Values read_in_place{static_cast<const std::byte*>(values.data()), stride,
                                         single, are_radii};
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::regular(input, read_in_place, skip_non_finite, {threads, shared},
                                 interrupt);
    });
    const nb::tuple found = as_tuple(outcome);  // first: it raises after an interrupt
    return nb::make_tuple(found, skipped(outcome.hidden));
}

nb::tuple farthest(const PlanarRows& rows, bool skip_non_finite, unsigned threads, bool shared,
                   nb::handle progress) {
    const Input input = read(rows);
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::farthest(input, skip_non_finite, {threads, shared}, interrupt);
    });
    return nb::make_tuple(as_tuple(outcome), skipped(outcome.hidden));
}

nb::tuple delaunay_by_metric(const PlanarRows& rows, double a, double b, double c,
                             bool skip_non_finite, unsigned threads, bool shared,
                             nb::handle progress) {
    const Input input = read(rows);
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::delaunay({a, b, c}, input, skip_non_finite, {threads, shared}, interrupt);
    });
    return as_tuple(outcome);
}

}  // namespace

void bind_lifted(nb::module_& m) {
    m.def("lifted_side", &lifted_side, "a"_a, "b"_a, "c"_a, "d"_a, "values"_a, "lift"_a, "signs"_a,
          "canonical"_a);
    m.def("regular", &regular, "rows"_a, "values"_a, "are_radii"_a, "skip_non_finite"_a,
          "threads"_a, "shared"_a, "progress"_a.none());
    m.def("farthest", &farthest, "rows"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none());
    m.def("delaunay_by_metric", &delaunay_by_metric, "rows"_a, "a"_a, "b"_a, "c"_a,
          "skip_non_finite"_a, "threads"_a, "shared"_a, "progress"_a.none());
    m.def("height_between", &height_between, "a"_a, "b"_a, "c"_a, "values"_a, "lift"_a, "signs"_a);
}

}  // namespace bindings
