// What the bindings of engines and predicates share: the caller's rows, signs, and outcomes.
#pragma once

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "base/floating_point.hpp"
#include "bindings.hpp"
#include "delaunay/delaunay.hpp"
#include "parallel/blocks.hpp"

namespace bindings {

using liftmesh::Input;
using liftmesh::Point;
using liftmesh::Row;

using PlanarRows = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
using Pairs = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Triples = nb::ndarray<const std::int32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Signs = nb::ndarray<std::int8_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

inline Input read(const PlanarRows& rows) {
    const bool single = rows.dtype() == nb::dtype<float>();
    if (!single && rows.dtype() != nb::dtype<double>())
        throw std::invalid_argument("rows must be float64 or float32");
    if (rows.shape(1) < 2) throw std::invalid_argument("rows need two columns");
    if (rows.shape(0) > liftmesh::most_rows) throw std::invalid_argument("too many rows");
    const auto size = static_cast<std::ptrdiff_t>(rows.itemsize());
    return {static_cast<const std::byte*>(rows.data()), rows.shape(0), rows.stride(0) * size,
            rows.stride(1) * size, single};
}

// Most results have no skipped rows or duplicates: theirs are views of one empty array, which are
// made in half the time of an array. (Of a view shape and type can be changed, in place, by whoever
// has it. Of two threads that race here one keeps its array.)
inline nb::object nothing(std::size_t columns) {
    static std::atomic<PyObject*> none[2] = {};
    std::atomic<PyObject*>& shared = none[columns - 1];
    PyObject* known = shared.load(std::memory_order_acquire);
    if (!known) {
        nb::object made = adopt(liftmesh::allocate<std::int32_t>(0), 0, columns);
        if (shared.compare_exchange_strong(known, made.ptr(), std::memory_order_acq_rel))
            known = made.release().ptr();
    }
    return nb::borrow(known).attr("view")();
}

template <class T>
nb::object as_array(const std::vector<T>& values) {
    auto copy = liftmesh::allocate<T>(values.size());
    std::copy(values.begin(), values.end(), copy.get());
    return adopt(std::move(copy), values.size(), 1);
}

template <class Source, class Write>
nb::object table(const std::vector<Source>& source, std::size_t columns, Write write) {
    if (source.empty() && columns <= 2) return nothing(columns);
    auto values = liftmesh::allocate<std::int32_t>(columns * source.size());
    for (std::size_t i = 0; i < source.size(); ++i) write(source[i], &values[columns * i]);
    return adopt(std::move(values), source.size(), columns);
}

inline nb::object duplicates(const std::vector<liftmesh::Duplicate>& pairs) {
    return table(pairs, 2, [](const liftmesh::Duplicate& pair, std::int32_t* out) {
        out[0] = static_cast<std::int32_t>(pair.row);
        out[1] = static_cast<std::int32_t>(pair.kept);
    });
}

inline nb::object skipped(const std::vector<Row>& rows) {
    return table(rows, 1,
                 [](Row row, std::int32_t* out) { *out = static_cast<std::int32_t>(row); });
}

inline const char* name(liftmesh::Status status) {
    switch (status) {
        case liftmesh::Status::ok:
            return "ok";
        case liftmesh::Status::non_finite:
            return "non-finite";
        case liftmesh::Status::too_few:
            return "too few";
        case liftmesh::Status::collinear:
            return "collinear";
        // GCOV_EXCL_START: an interrupted run ends in an exception
        case liftmesh::Status::interrupted:
            return "interrupted";
            // GCOV_EXCL_STOP
    }
    return "";
}

struct Arrays {
    nb::object simplices, neighbors, hull;
};

// Views of one array, whose rows are triangles, neighbours, and the hull in the first column: the
// interpreter takes less time for these than for three arrays, and that is most of a small call.
inline Arrays packed(const liftmesh::Result& result) {
    const std::size_t triangles = result.triangle_count, hull = result.hull_count;
    const std::size_t rows = 2 * triangles + hull, words = 3 * triangles;
    auto values = liftmesh::allocate<std::int32_t>(3 * rows);
    std::copy_n(result.simplices.get(), words, values.get());
    std::copy_n(result.neighbors.get(), words, values.get() + words);
    for (std::size_t i = 0; i < hull; ++i) values[2 * words + 3 * i] = result.hull[i];
    const nb::object all = adopt(std::move(values), rows, 3);
    return {nb::object(all[nb::slice(std::size_t{0}, triangles)]),
            nb::object(all[nb::slice(triangles, 2 * triangles)]),
            nb::object(all[nb::make_tuple(nb::slice(2 * triangles, rows), 0)])};
}

inline Arrays arrays(liftmesh::Result& result) {
    constexpr std::size_t few = 128;
    if (result.triangle_count > 0 && result.triangle_count < few) return packed(result);
    return {adopt(std::move(result.simplices), result.triangle_count, 3),
            adopt(std::move(result.neighbors), result.triangle_count, 3),
            adopt(std::move(result.hull), result.hull_count, 1)};
}

inline nb::tuple as_tuple(liftmesh::Delaunay& outcome) {
    if (outcome.status == liftmesh::Status::interrupted) throw nb::python_error();
    auto [simplices, neighbors, hull] = arrays(outcome.result);
    return nb::make_tuple(name(outcome.status), outcome.row, outcome.distinct, simplices, neighbors,
                          hull, duplicates(outcome.duplicates), skipped(outcome.skipped));
}

// For runs that end long before a signal or `progress` would be due: each look at the clock takes
// as long as a point.
class NoInterrupt final : public liftmesh::Interrupt {
 public:
    bool requested() override { return false; }
};

inline Point point(const Pairs& pairs, std::size_t i) {
    return {pairs.data()[2 * i], pairs.data()[2 * i + 1]};
}

// A number that nobody can foresee.
inline std::uint64_t new_secret() {
    std::random_device random;
    return std::uint64_t{random()} << 32 | random();
}

// signs[i] = sign(i), without the GIL.
template <class Sign>
void fill(const Signs& signs, Sign sign) {
    PythonInterrupt interrupt;
    bool done = false;
    {
        const nb::gil_scoped_release unlocked;
        const liftmesh::IeeeArithmetic ieee;
        done = liftmesh::for_each_in_blocks(signs.shape(0), interrupt, [&](std::size_t i) {
            signs.data()[i] = static_cast<std::int8_t>(sign(i));
        });
    }
    if (!done) throw nb::python_error();
}

// One value for each row.
using Column = nb::ndarray<nb::ro, nb::ndim<1>, nb::device::cpu>;

// Stars in metrics of their own.
void bind_anisotropic(nb::module_& m);

// The graph of disks.
void bind_apollonius(nb::module_& m);

// The predicates and the engine of lifted points.
void bind_lifted(nb::module_& m);

// Surfaces: heights, rasters, contours.
void bind_surface(nb::module_& m);

// Calls run() with large arrays in files of a folder, unless that is None, and without the GIL.
// What the disk reports becomes an OSError.
template <class Run>
void run_in_files(nb::handle name, Run run) {
    const char* const folder = name.is_none() ? nullptr : nb::borrow<nb::str>(name).c_str();
    try {
        const nb::gil_scoped_release unlocked;
        const liftmesh::InFiles files(folder);
        run();
    } catch (const std::system_error& error) {
        if (folder == nullptr) throw;
        errno = error.code().value();
        PyErr_SetFromErrnoWithFilename(PyExc_OSError, folder);
        throw nb::python_error();
    }
}

// What tiled triangulations consist of.
void bind_tiles(nb::module_& m);

void bind_verify(nb::module_& m);

// Voronoi and power diagrams.
void bind_cells(nb::module_& m);

// Triangulations that change.
void bind_dynamic(nb::module_& m);

}  // namespace bindings
