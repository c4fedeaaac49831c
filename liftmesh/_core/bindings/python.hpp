// What the bindings of all rooms use: signals and progress, arrays of the caller and for the
// caller, runs without the GIL, and their outcomes.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <random>

#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "base/status.hpp"
#include "delaunay/delaunay.hpp"
#include "parallel/blocks.hpp"
#include "predicates/orient3d.hpp"
#include "verify/flaws.hpp"

namespace bindings {

namespace nb = nanobind;
using namespace nb::literals;
using liftmesh::Input;
using liftmesh::Point;
using liftmesh::Row;

// Checks for pending signals and reports progress, about twenty times a second. Python delivers
// signals to its main thread only; on any other thread only an exception from `progress` ends a
// run.
class PythonInterrupt final : public liftmesh::Interrupt {
 public:
    explicit PythonInterrupt(nb::handle progress = nb::none()) : progress_(progress) {}

    bool requested() override {
        const Clock::time_point now = Clock::now();
        if (requested_ || now < due_) return requested_;
        due_ = now + std::chrono::milliseconds(50);
        const nb::gil_scoped_acquire gil;
        requested_ = PyErr_CheckSignals() != 0 || !report_progress() || forked();
        return requested_;
    }
    void expect(std::size_t work) override { expected_ = work; }
    void advance(std::size_t work) override { done_ += work; }

 private:
    using Clock = std::chrono::steady_clock;

    bool report_progress() const {
        if (progress_.is_none() || done_ >= expected_) return true;
        try {
            progress_(static_cast<double>(done_) / static_cast<double>(expected_));
            return true;
        } catch (nb::python_error& error) {
            error.restore();
        } catch (const std::bad_alloc&) {
            PyErr_NoMemory();  // GCOV_EXCL_LINE: between a callback and its number
        }
        return false;
    }

    // The child of a fork made by a signal handler, or by `progress`, cannot continue: it has none
    // of the run's threads.
    bool forked() const {
        if (liftmesh::forks_so_far() == forks_) return false;
        // GCOV_EXCL_START: the child of a fork ends without writing its counts
        PyErr_SetString(PyExc_RuntimeError,
                        "the process was forked during a run, which continues in the parent only: "
                        "fork before or after it");
        return true;
        // GCOV_EXCL_STOP
    }

    nb::handle progress_;
    unsigned forks_ = liftmesh::forks_so_far();
    Clock::time_point due_ = Clock::now() + std::chrono::milliseconds(50);
    bool requested_ = false;
    std::size_t expected_ = 0;
    std::atomic<std::size_t> done_ = 0;
};

template <class T>
nb::object adopt(liftmesh::Buffer<T> values, std::size_t rows, std::size_t columns) {
    const nb::capsule owner(values.get(), [](void* p) noexcept { liftmesh::Free()(p); });
    T* data = values.release();
    const std::size_t shape[2] = {rows, columns};
    return nb::cast(nb::ndarray<nb::numpy, const T>(data, columns == 1 ? 1 : 2, shape, owner));
}

// Arrays of the caller, whose rows have as many columns as stated.
template <class T, int... columns>
using Array = nb::ndarray<T, nb::shape<-1, columns...>, nb::c_contig, nb::device::cpu>;
using Pairs = Array<const double, 2>;
using Places = Array<const double, 3>;
using ChangingPlaces = Array<double, 3>;
using Triples = Array<const std::int32_t, 3>;
using Numbers = Array<const double>;
using Ids = Array<const std::int32_t>;
using ChangingIds = Array<std::int32_t>;
using Signs = Array<std::int8_t>;
using ChangingFlags = Array<std::uint8_t>;
using PlanarRows = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
using Column = nb::ndarray<nb::ro, nb::ndim<1>, nb::device::cpu>;  // one value for each row

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

// Items that consist of numbers, each as a row of these.
template <class Number, class Item>
nb::object array_of(const std::vector<Item>& items) {
    constexpr std::size_t columns = sizeof(Item) / sizeof(Number);
    auto values = liftmesh::allocate<Number>(columns * items.size());
    std::copy_n(reinterpret_cast<const Number*>(items.data()), columns * items.size(),
                values.get());
    return adopt(std::move(values), items.size(), columns);
}

inline nb::object duplicates(const std::vector<liftmesh::Duplicate>& pairs) {
    return pairs.empty() ? nothing(2) : array_of<std::int32_t>(pairs);
}

inline nb::object skipped(const std::vector<Row>& rows) {
    return rows.empty() ? nothing(1) : array_of<std::int32_t>(rows);
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
        case liftmesh::Status::coplanar:
            return "coplanar";
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

inline void raise_if(bool is_interrupted) {
    if (is_interrupted) throw nb::python_error();
}

inline nb::tuple as_tuple(liftmesh::Delaunay& outcome) {
    raise_if(outcome.status == liftmesh::Status::interrupted);
    auto [simplices, neighbors, hull] = arrays(outcome.result);
    return nb::make_tuple(name(outcome.status), outcome.row, outcome.distinct, simplices, neighbors,
                          hull, duplicates(outcome.duplicates), skipped(outcome.skipped));
}

inline Point point(const Pairs& pairs, std::size_t i) {
    return {pairs.data()[2 * i], pairs.data()[2 * i + 1]};
}

inline const liftmesh::SpacePoint* points(const Places& places) {
    static_assert(sizeof(liftmesh::SpacePoint) == 3 * sizeof(double));
    return reinterpret_cast<const liftmesh::SpacePoint*>(places.data());
}

// A number that nobody can foresee.
inline std::uint64_t new_secret() {
    std::random_device random;
    return std::uint64_t{random()} << 32 | random();
}

// What work(interrupt) returns, without the GIL and in IEEE arithmetic.
template <class Work>
auto unlocked(nb::handle progress, Work work) {
    PythonInterrupt interrupt(progress);
    const nb::gil_scoped_release unlocked;
    const liftmesh::IeeeArithmetic ieee;
    return work(interrupt);
}

// The same for work that returns whether it went to its end: raises if not.
template <class Work>
void run_unlocked(Work work, nb::handle progress = nb::none()) {
    raise_if(!unlocked(progress, work));
}

// signs[i] = sign(i).
template <class Sign>
void fill(const Signs& signs, Sign sign) {
    run_unlocked([&](auto& interrupt) {
        return liftmesh::for_each_in_blocks(signs.shape(0), interrupt, [&](std::size_t i) {
            signs.data()[i] = static_cast<std::int8_t>(sign(i));
        });
    });
}

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

// The count and the first places of each kind of flaw, in the order of the enumeration.
template <class Kind>
nb::list as_list(const liftmesh::FlawsOf<Kind>& flaws) {
    nb::list kinds;
    for (std::size_t kind = 0; kind < static_cast<std::size_t>(Kind::kinds); ++kind) {
        const liftmesh::FlawPlaces& places = flaws[static_cast<Kind>(kind)];
        nb::list first;
        for (const liftmesh::FlawPlace& place : places.first())
            first.append(nb::make_tuple(place.at, place.other));
        kinds.append(nb::make_tuple(places.count(), first));
    }
    return kinds;
}

// The functions and classes of each room.
void bind_alpha(nb::module_& m);
void bind_anisotropic(nb::module_& m);
void bind_apollonius(nb::module_& m);
void bind_cells(nb::module_& m);
void bind_constrained(nb::module_& m);
void bind_refinement(nb::module_& m);
void bind_space(nb::module_& m);
void bind_sphere(nb::module_& m);
void bind_dynamic(nb::module_& m);
void bind_lifted(nb::module_& m);
void bind_proximity(nb::module_& m);
void bind_surface(nb::module_& m);
void bind_text(nb::module_& m);
void bind_tiles(nb::module_& m);
void bind_verify(nb::module_& m);

}  // namespace bindings
