// The Python bindings: arrays in, arrays out, with the GIL released in between.

#include "bindings/locator.hpp"
#include "bindings/python.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/many.hpp"
#include "hull/lower_hull.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/triangle_order.hpp"

namespace bindings {

namespace {

nb::tuple delaunay(const PlanarRows& rows, bool skip_non_finite, unsigned threads, bool shared,
                   nb::handle progress, nb::handle folder) {
    // Few rows end long before a signal or `progress` would be due, in 10 ms at worst, and each
    // look at the clock takes as long as a point.
    constexpr std::size_t few = 512;
    const Input input = read(rows);
    liftmesh::Delaunay outcome;
    const auto run = [&](liftmesh::Interrupt&& interrupt) {
        run_in_files(folder, [&] {
            outcome = liftmesh::delaunay(input, skip_non_finite, {threads, shared}, interrupt);
        });
    };
    input.rows < few ? run(liftmesh::NoInterrupt()) : run(PythonInterrupt(progress));
    return as_tuple(outcome);
}

// A list of all parts, in one array.
template <class Number, class Item>
nb::object joined(const std::vector<liftmesh::Sets>& parts,
                  std::vector<Item> liftmesh::Sets::* list, std::size_t columns) {
    std::size_t count = 0;
    for (const liftmesh::Sets& part : parts) count += (part.*list).size();
    constexpr std::size_t numbers = sizeof(Item) / sizeof(Number);
    auto all = liftmesh::allocate<Number>(numbers * count);
    Number* to = all.get();
    for (const liftmesh::Sets& part : parts) {
        const auto* const from = reinterpret_cast<const Number*>((part.*list).data());
        to = std::copy_n(from, numbers * (part.*list).size(), to);
    }
    return adopt(std::move(all), numbers * count / columns, columns);
}

// Where each set begins in one of the lists, and the end of the last.
nb::object starts(const std::vector<liftmesh::Sets>& parts, std::size_t liftmesh::Sets::End::* of) {
    std::vector<std::int64_t> all{0};
    for (const liftmesh::Sets& part : parts) {
        const std::int64_t before = all.back();
        for (const auto& end : part.ends)
            all.push_back(before + static_cast<std::int64_t>(end.*of));
    }
    return as_array(all);
}

nb::tuple delaunay_many(const PlanarRows& rows, const Array<const std::int64_t>& offsets,
                        bool skip_non_finite, unsigned threads, bool shared, nb::handle progress) {
    using liftmesh::Sets;
    const Input input = read(rows);
    std::vector<Sets> parts;
    run_unlocked(
        [&](auto& interrupt) {
            return liftmesh::delaunay_many(input, {offsets.data(), offsets.shape(0)},
                                           skip_non_finite, {threads, shared}, interrupt, parts);
        },
        progress);
    const auto wrong = std::find_if(parts.begin(), parts.end(), [](const Sets& part) {
        return part.status != liftmesh::Status::ok;
    });
    if (wrong != parts.end()) return nb::make_tuple(wrong->row);
    using End = Sets::End;
    return nb::make_tuple(
        joined<std::int32_t>(parts, &Sets::simplices, 3), starts(parts, &End::triangles),
        joined<std::int32_t>(parts, &Sets::neighbors, 3),
        joined<std::int32_t>(parts, &Sets::hull, 1), starts(parts, &End::hull),
        joined<std::int32_t>(parts, &Sets::duplicates, 2), starts(parts, &End::duplicates),
        joined<std::int32_t>(parts, &Sets::skipped, 1), starts(parts, &End::skipped));
}

// In the order of `Counters` in liftmesh.planar.lifting.
nb::tuple counts_as_tuple(const liftmesh::paper::Counts& counts) {
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
    liftmesh::paper::Counts counts;
    auto outcome = unlocked(progress, [&](auto& interrupt) {
        return liftmesh::wrap_delaunay(input, skip_non_finite, procedure, {qx, qy},
                                       {threads, shared}, interrupt, counts);
    });
    return nb::make_tuple(as_tuple(outcome), counts_as_tuple(counts));
}

nb::tuple lower_hull(const PlanarRows& rows, std::string_view method, std::uint64_t secret) {
    const Input input = read(rows);
    if (rows.shape(1) < 3) throw std::invalid_argument("rows need three columns");
    const auto engine =
        method == "lf" ? liftmesh::HullMethod::lf : liftmesh::HullMethod::incremental;
    liftmesh::paper::Counts counts;
    auto outcome = unlocked(nb::none(), [&](auto& interrupt) {
        return liftmesh::lower_hull(input, engine, secret, {}, interrupt, counts);
    });
    return nb::make_tuple(as_tuple(outcome), counts_as_tuple(counts));
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

// Triangles in canonical order, with neighbours and flags; rows are in order if there are no
// points.
nb::tuple canonical_order(const std::optional<PlanarRows>& points, const Triples& simplices,
                          const Triples& neighbors,
                          const std::optional<Array<const std::uint8_t>>& bits, std::size_t rows,
                          unsigned threads, bool shared) {
    const std::size_t count = simplices.shape(0);
    const liftmesh::Triangles given{simplices.data(), neighbors.data(),
                                    bits ? bits->data() : nullptr, count};
    liftmesh::OrderedTriangles ordered;
    run_unlocked([&](auto& interrupt) {
        std::vector<std::int32_t> ranks;
        if (points &&
            !liftmesh::rank_rows(read(*points), simplices.data(), count, ranks, interrupt))
            return false;
        liftmesh::ThreadPool pool(liftmesh::Threads{threads, shared}.for_rows(count), interrupt);
        return liftmesh::order_triangles(given, points ? ranks.data() : nullptr, rows, ordered,
                                         pool);
    });
    return nb::make_tuple(adopt(std::move(ordered.simplices), count, 3),
                          adopt(std::move(ordered.neighbors), count, 3),
                          adopt(std::move(ordered.bits), bits ? count : 0, 1));
}

void bind_planar(nb::module_& m) {
    m.def("canonical_order", &canonical_order, "points"_a.none(), "simplices"_a, "neighbors"_a,
          "bits"_a.none(), "rows"_a, "threads"_a, "shared"_a);
    m.def("delaunay", &delaunay, "rows"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none(), "folder"_a.none() = nb::none());
    m.def("delaunay_many", &delaunay_many, "rows"_a, "offsets"_a, "skip_non_finite"_a, "threads"_a,
          "shared"_a, "progress"_a.none());
    m.def("gift_wrap", &gift_wrap, "rows"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none(), "method"_a, "qx"_a, "qy"_a);
    m.def("lower_hull", &lower_hull, "rows"_a, "method"_a, "secret"_a);
    m.def("orient2d", &orient2d, "a"_a, "b"_a, "c"_a, "signs"_a);
    m.def("incircle", &incircle, "a"_a, "b"_a, "c"_a, "d"_a, "signs"_a, "canonical"_a);
    nb::class_<PyLocator>(m, "Locator")
        .def(nb::init<PlanarRows, Triples, Triples>(), "points"_a, "simplices"_a, "neighbors"_a)
        .def("find", &PyLocator::find, "queries"_a, "found"_a, "threads"_a, "shared"_a);
}

// What a report of a bug has to name. Nothing is chosen at run time: the kernel has the
// instructions that it was compiled for.
#if defined(__clang__)
constexpr const char* compiler = "Clang " __clang_version__;
#elif defined(__GNUC__)
constexpr const char* compiler = "GCC " __VERSION__;
#else
constexpr const char* compiler = "unknown";
#endif

#if defined(__AVX512F__)
constexpr const char* instructions = "AVX-512";
#elif defined(__AVX2__)
constexpr const char* instructions = "AVX2";
#elif defined(__SSE4_2__)
constexpr const char* instructions = "SSE4.2";
#elif defined(__SSE2__)
constexpr const char* instructions = "SSE2";
#elif defined(__ARM_NEON)
constexpr const char* instructions = "NEON";
#else
constexpr const char* instructions = "basic";
#endif

}  // namespace

}  // namespace bindings

NB_MODULE(_kernel, m) {
    liftmesh::refuse_contraction(liftmesh::contracts());
    m.doc() = "The compiled kernel of liftmesh. Its callers check their arguments.";
    m.attr("VERSION") = LIFTMESH_VERSION;
    m.attr("COMPILER") = bindings::compiler;
    m.attr("INSTRUCTIONS") = bindings::instructions;
    m.attr("MOST_ROWS") = liftmesh::most_rows;
    m.attr("ROWS_PER_THREAD") = liftmesh::rows_per_thread;
    bindings::bind_planar(m);
    bindings::bind_text(m);
    bindings::bind_alpha(m);
    bindings::bind_anisotropic(m);
    bindings::bind_apollonius(m);
    bindings::bind_dynamic(m);
    bindings::bind_lifted(m);
    bindings::bind_proximity(m);
    bindings::bind_surface(m);
    bindings::bind_tiles(m);
    bindings::bind_verify(m);
    bindings::bind_cells(m);
    bindings::bind_constrained(m);
    bindings::bind_refinement(m);
    bindings::bind_space(m);
    bindings::bind_sphere(m);
}
