// The Python interface of disks.

#include "apollonius/apollonius.hpp"

#include "bindings/python.hpp"
#include "verify/disks.hpp"

namespace bindings {

namespace {

using liftmesh::apollonius::Disk;
using Disks = Array<const double, 3>;

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

nb::object first_of_each(const std::vector<std::array<Row, 2>>& pairs) {
    return parts<std::int32_t>(pairs, 1, [](const auto& pair, std::int32_t* out) {
        *out = static_cast<std::int32_t>(pair[0]);
    });
}

nb::tuple graph_tuple(const liftmesh::apollonius::Outcome& outcome) {
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
                          array_of<std::int32_t>(outcome.hull), first_of_each(outcome.hidden),
                          array_of<std::int32_t>(outcome.duplicates));
}

nb::tuple apollonius(const Disks& rows, nb::handle progress) {
    std::vector<Disk> disks = read_disks(rows);
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::apollonius::apollonius(std::move(disks), new_secret(), interrupt);
    });
    raise_if(outcome.status == liftmesh::Status::interrupted);
    return graph_tuple(outcome);
}

template <class Values>
auto span_of(const Values& values) {
    return std::span(values.data(), values.shape(0));
}

// The lists of a graph, each as one row.
nb::tuple verify(const Disks& rows, const Ids& simplices, const Ids& neighbors,
                 const Numbers& circles, const Ids& hull, const Ids& hidden, const Ids& duplicates,
                 unsigned threads, bool shared, nb::handle progress) {
    const std::size_t corners = simplices.shape(0);
    if (corners % 3 != 0 || neighbors.shape(0) != corners || circles.shape(0) != corners ||
        hull.shape(0) % 2 != 0 || duplicates.shape(0) % 2 != 0)
        throw std::invalid_argument("lengths differ");
    const std::vector<Disk> disks = read_disks(rows);
    const liftmesh::DiskGraph graph{disks,           span_of(simplices), span_of(neighbors),
                                    span_of(hull),   span_of(hidden),    span_of(duplicates),
                                    span_of(circles)};
    auto verdict = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::verify(graph, new_secret(), {threads, shared}, interrupt);
    });
    raise_if(verdict.status == liftmesh::Status::interrupted);
    return nb::make_tuple(verdict.vertices, as_list(verdict.flaws));
}

nb::tuple binary_range(const Disks& rows) {
    const auto range = liftmesh::apollonius::range_of(read_disks(rows));
    return nb::make_tuple(range.high - range.low, range.finest, range.largest);
}

}  // namespace

void bind_apollonius(nb::module_& m) {
    m.attr("WIDEST_RANGE_OF_DISKS") = liftmesh::apollonius::widest_range;
    m.def("apollonius", &apollonius, "disks"_a, "progress"_a.none());
    m.def("verify_apollonius", &verify, "disks"_a, "simplices"_a, "neighbors"_a, "circles"_a,
          "hull"_a, "hidden"_a, "duplicates"_a, "threads"_a, "shared"_a, "progress"_a.none());
    m.def("binary_range", &binary_range, "disks"_a);
}

}  // namespace bindings
