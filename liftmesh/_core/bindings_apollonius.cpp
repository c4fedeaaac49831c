// The Python interface of disks.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>

#include "apollonius/apollonius.hpp"
#include "bindings_runs.hpp"

namespace bindings {

using namespace nb::literals;

namespace {

using liftmesh::apollonius::Disk;
using Disks = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

std::vector<Disk> read_disks(const Disks& rows) {
    std::vector<Disk> disks;
    disks.reserve(rows.shape(0));
    for (std::size_t i = 0; i < rows.shape(0); ++i) {
        const double* row = rows.data() + 3 * i;
        disks.push_back({row[0] + 0.0, row[1] + 0.0, row[2] + 0.0});
    }
    return disks;
}

// An array of what `part` gives of each item.
template <class Value, class Items, class Part>
nb::object parts(const Items& items, std::size_t columns, Part part) {
    auto values = liftmesh::allocate<Value>(columns * items.size());
    for (std::size_t i = 0; i < items.size(); ++i) part(items[i], &values[columns * i]);
    return adopt(std::move(values), items.size(), columns);
}

nb::object pairs(const auto& items) {
    return parts<std::int32_t>(items, 2, [](const auto& item, std::int32_t* out) {
        out[0] = static_cast<std::int32_t>(item[0]);
        out[1] = static_cast<std::int32_t>(item[1]);
    });
}

nb::tuple as_tuple(const liftmesh::apollonius::Outcome& outcome) {
    using liftmesh::apollonius::Triangle;
    const auto& triangles = outcome.triangles;
    return nb::make_tuple(parts<std::int32_t>(triangles, 3,
                                              [](const Triangle& t, std::int32_t* out) {
                                                  std::copy_n(t.corners.data(), 3, out);
                                              }),
                          parts<std::int32_t>(triangles, 3,
                                              [](const Triangle& t, std::int32_t* out) {
                                                  std::copy_n(t.neighbors.data(), 3, out);
                                              }),
                          parts<double>(triangles, 3,
                                        [](const Triangle& t, double* out) {
                                            out[0] = t.circle.x;
                                            out[1] = t.circle.y;
                                            out[2] = t.circle.radius;
                                        }),
                          pairs(outcome.hull), skipped(outcome.hidden), pairs(outcome.duplicates));
}

nb::tuple apollonius(const Disks& rows, nb::handle progress) {
    std::vector<Disk> disks = read_disks(rows);
    PythonInterrupt interrupt(progress);
    liftmesh::apollonius::Outcome outcome;
    {
        const nb::gil_scoped_release unlocked;
        const liftmesh::IeeeArithmetic ieee;
        outcome = liftmesh::apollonius::apollonius(std::move(disks), new_secret(), interrupt);
    }
    if (outcome.status == liftmesh::Status::interrupted) throw nb::python_error();
    return as_tuple(outcome);
}

nb::tuple binary_range(const Disks& rows) {
    const auto range = liftmesh::apollonius::range_of(read_disks(rows));
    return nb::make_tuple(range.high - range.low, range.finest, range.largest);
}

}  // namespace

void bind_apollonius(nb::module_& m) {
    m.attr("WIDEST_RANGE_OF_DISKS") = liftmesh::apollonius::widest_range;
    m.def("apollonius", &apollonius, "disks"_a, "progress"_a.none());
    m.def("binary_range", &binary_range, "disks"_a);
}

}  // namespace bindings
