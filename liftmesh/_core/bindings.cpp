// The Python bindings: arrays in, arrays out, with the GIL released in between.

#include "bindings.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "base/floating_point.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "hull/gift_wrapping.hpp"
#include "hull/lower_hull.hpp"
#include "parallel/blocks.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "verify/verify.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using bindings::adopt;
using bindings::PythonInterrupt;

namespace {

using liftmesh::Input;
using liftmesh::Point;
using liftmesh::Row;

using PlanarRows = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
using Pairs = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Triples = nb::ndarray<const std::int32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Signs = nb::ndarray<std::int8_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Ids = nb::ndarray<std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

Input read(const PlanarRows& rows) {
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
// has it. Two threads that race here make an array each; either is valid.)
nb::object nothing(std::size_t columns) {
    static PyObject* none[2] = {};
    PyObject*& shared = none[columns - 1];
    if (!shared) shared = adopt(liftmesh::allocate<std::int32_t>(0), 0, columns).release().ptr();
    return nb::borrow(shared).attr("view")();
}

template <class Source, class Write>
nb::object table(const std::vector<Source>& source, std::size_t columns, Write write) {
    if (source.empty()) return nothing(columns);
    auto values = liftmesh::allocate<std::int32_t>(columns * source.size());
    for (std::size_t i = 0; i < source.size(); ++i) write(source[i], &values[columns * i]);
    return adopt(std::move(values), source.size(), columns);
}

nb::object duplicates(const std::vector<liftmesh::Duplicate>& pairs) {
    return table(pairs, 2, [](const liftmesh::Duplicate& pair, std::int32_t* out) {
        out[0] = static_cast<std::int32_t>(pair.row);
        out[1] = static_cast<std::int32_t>(pair.kept);
    });
}

nb::object skipped(const std::vector<Row>& rows) {
    return table(rows, 1,
                 [](Row row, std::int32_t* out) { *out = static_cast<std::int32_t>(row); });
}

const char* name(liftmesh::Status status) {
    switch (status) {
        case liftmesh::Status::ok:
            return "ok";
        case liftmesh::Status::non_finite:
            return "non-finite";
        case liftmesh::Status::too_few:
            return "too few";
        case liftmesh::Status::collinear:
            return "collinear";
        case liftmesh::Status::interrupted:
            return "interrupted";
    }
    return "";
}

struct Arrays {
    nb::object simplices, neighbors, hull;
};

// Views of one array, whose rows are triangles, neighbours, and the hull in the first column: the
// interpreter takes less time for these than for three arrays, and that is most of a small call.
Arrays packed(const liftmesh::Result& result) {
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

Arrays arrays(liftmesh::Result& result) {
    constexpr std::size_t few = 128;
    if (result.triangle_count > 0 && result.triangle_count < few) return packed(result);
    return {adopt(std::move(result.simplices), result.triangle_count, 3),
            adopt(std::move(result.neighbors), result.triangle_count, 3),
            adopt(std::move(result.hull), result.hull_count, 1)};
}

nb::tuple as_tuple(liftmesh::Delaunay& outcome) {
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

nb::tuple delaunay(const PlanarRows& rows, bool skip_non_finite, unsigned threads, bool shared,
                   nb::handle progress) {
    constexpr std::size_t few = 512;  // the worst of them take 10 ms
    const Input input = read(rows);
    liftmesh::Delaunay outcome;
    const auto run = [&](liftmesh::Interrupt&& interrupt) {
        const nb::gil_scoped_release unlocked;
        outcome = liftmesh::delaunay(input, skip_non_finite, {threads, shared}, interrupt);
    };
    input.rows < few ? run(NoInterrupt()) : run(PythonInterrupt(progress));
    return as_tuple(outcome);
}

// In the order of `Counters` in liftmesh.planar.counters.
nb::tuple as_tuple(const liftmesh::paper::Counts& counts) {
    const auto& [i, ii, iii, iv, v, below] = counts.rejected;
    return nb::make_tuple(counts.calls, counts.candidate_planes, counts.evaluations,
                          nb::make_tuple(i, ii, iii, iv, v, below), counts.undecided);
}

liftmesh::Procedure procedure_named(std::string_view method) {
    if (method == "lf") return liftmesh::Procedure::lf;
    if (method == "lfres") return liftmesh::Procedure::lfres;
    if (method == "lfres-indexed") return liftmesh::Procedure::lfres_indexed;
    throw std::invalid_argument("unknown method");
}

nb::tuple gift_wrap(const PlanarRows& rows, bool skip_non_finite, unsigned threads, bool shared,
                    nb::handle progress, std::string_view method, double qx, double qy) {
    const Input input = read(rows);
    const liftmesh::Procedure procedure = procedure_named(method);
    PythonInterrupt interrupt(progress);
    liftmesh::Delaunay outcome;
    liftmesh::paper::Counts counts;
    {
        const nb::gil_scoped_release unlocked;
        outcome = liftmesh::wrap_delaunay(input, skip_non_finite, procedure, {qx, qy},
                                          {threads, shared}, interrupt, counts);
    }
    return nb::make_tuple(as_tuple(outcome), as_tuple(counts));
}

nb::tuple lower_hull(const PlanarRows& rows, std::string_view method, std::uint64_t secret) {
    const Input input = read(rows);
    if (rows.shape(1) < 3) throw std::invalid_argument("rows need three columns");
    const auto engine =
        method == "lf" ? liftmesh::HullMethod::lf : liftmesh::HullMethod::incremental;
    PythonInterrupt interrupt;
    liftmesh::Delaunay outcome;
    liftmesh::paper::Counts counts;
    {
        const nb::gil_scoped_release unlocked;
        outcome = liftmesh::lower_hull(input, engine, secret, {}, interrupt, counts);
    }
    return nb::make_tuple(as_tuple(outcome), as_tuple(counts));
}

// The count and the first places of each kind of flaw, in the order of the enumeration.
nb::list as_list(const liftmesh::Flaws& flaws) {
    nb::list kinds;
    for (std::size_t kind = 0; kind < static_cast<std::size_t>(liftmesh::Flaw::kinds); ++kind) {
        const liftmesh::Places& places = flaws[static_cast<liftmesh::Flaw>(kind)];
        nb::list first;
        for (const liftmesh::Place& place : places.first())
            first.append(nb::make_tuple(place.at, place.other));
        kinds.append(nb::make_tuple(places.count(), first));
    }
    return kinds;
}

nb::tuple verify(const PlanarRows& rows, const Triples& simplices, bool skip_non_finite,
                 unsigned threads, bool shared, nb::handle progress) {
    const Input input = read(rows);
    PythonInterrupt interrupt(progress);
    liftmesh::Verdict verdict;
    {
        const nb::gil_scoped_release unlocked;
        verdict = liftmesh::verify(input, simplices.data(), simplices.shape(0), skip_non_finite,
                                   {threads, shared}, interrupt);
    }
    if (verdict.status == liftmesh::Status::interrupted) throw nb::python_error();
    return nb::make_tuple(name(verdict.status), verdict.row, verdict.skipped, verdict.vertices,
                          verdict.merged, verdict.interior_edges, verdict.boundary_edges,
                          as_list(verdict.flaws));
}

// Keeps the arrays it reads alive.
class PyLocator {
 public:
    PyLocator(PlanarRows points, Triples simplices, Triples neighbors)
        : points_(std::move(points)),
          simplices_(std::move(simplices)),
          neighbors_(std::move(neighbors)),
          locator_(make()) {}

    void find(const Pairs& queries, const Ids& found, unsigned threads, bool shared) {
        if (queries.shape(0) != found.shape(0)) throw std::invalid_argument("lengths differ");
        PythonInterrupt interrupt;
        bool done = false;
        {
            const nb::gil_scoped_release unlocked;
            done = locator_.find({queries.data(), queries.shape(0)}, found.data(),
                                 {threads, shared}, interrupt);
        }
        if (!done) throw nb::python_error();
    }

 private:
    liftmesh::Locator make() const {
        const liftmesh::Triangulated triangulated{read(points_), simplices_.data(),
                                                  neighbors_.data(), simplices_.shape(0)};
        const nb::gil_scoped_release unlocked;
        std::random_device random;
        const std::uint64_t secret = std::uint64_t{random()} << 32 | random();
        return liftmesh::Locator(triangulated, secret);
    }

    PlanarRows points_;
    Triples simplices_, neighbors_;
    liftmesh::Locator locator_;
};

Point point(const Pairs& pairs, std::size_t i) {
    return {pairs.data()[2 * i], pairs.data()[2 * i + 1]};
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

void orient2d(const Pairs& a, const Pairs& b, const Pairs& c, const Signs& signs) {
    fill(signs,
         [&](std::size_t i) { return liftmesh::orient2d(point(a, i), point(b, i), point(c, i)); });
}

void incircle(const Pairs& a, const Pairs& b, const Pairs& c, const Pairs& d, const Signs& signs,
              bool canonical) {
    const auto test = canonical ? liftmesh::incircle_canonical_exact : liftmesh::incircle_exact;
    fill(signs, [&](std::size_t i) {
        return test(point(a, i), point(b, i), point(c, i), point(d, i),
                    liftmesh::Guard::anywhere());
    });
}

}  // namespace

NB_MODULE(_kernel, m) {
    liftmesh::refuse_contraction(liftmesh::contracts());
    m.doc() = "The compiled kernel of liftmesh. Its callers check their arguments.";
    m.attr("VERSION") = LIFTMESH_VERSION;
    m.attr("MOST_ROWS") = liftmesh::most_rows;
    m.attr("ROWS_PER_THREAD") = liftmesh::rows_per_thread;
    m.def("delaunay", &delaunay, "rows"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none());
    m.def("gift_wrap", &gift_wrap, "rows"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none(), "method"_a, "qx"_a, "qy"_a);
    m.def("lower_hull", &lower_hull, "rows"_a, "method"_a, "secret"_a);
    m.def("verify", &verify, "rows"_a, "simplices"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none());
    m.def("orient2d", &orient2d, "a"_a, "b"_a, "c"_a, "signs"_a);
    m.def("incircle", &incircle, "a"_a, "b"_a, "c"_a, "d"_a, "signs"_a, "canonical"_a);
    bindings::bind_text(m);
    nb::class_<PyLocator>(m, "Locator")
        .def(nb::init<PlanarRows, Triples, Triples>(), "points"_a, "simplices"_a, "neighbors"_a)
        .def("find", &PyLocator::find, "queries"_a, "found"_a, "threads"_a, "shared"_a);
}
