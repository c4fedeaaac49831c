// The Python interface of the verifier. Rows without a vertex are located by the index of
// `find_simplex`; the verifier checks its answers.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bindings_flaws.hpp"
#include "bindings_runs.hpp"
#include "delaunay/locate.hpp"
#include "verify/open_edges.hpp"
#include "verify/verify.hpp"

namespace bindings {

using namespace nb::literals;
using liftmesh::Member;

namespace {

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// The values are those of the rows, or the three coefficients of a metric.
Member member_named(std::string_view name, const Numbers& values, std::size_t rows) {
    const double* v = values.data();
    if (name == "delaunay") return {};
    if (name == "farthest") return {Member::Kind::farthest, nullptr, {}};
    const std::size_t needed = name == "metric" ? 3 : rows;
    if (values.shape(0) != needed) throw std::invalid_argument("lengths differ");
    if (name == "metric") return {Member::Kind::metric, nullptr, {v[0], v[1], v[2]}};
    if (name == "weights") return {Member::Kind::weights, v, {}};
    if (name == "radii") return {Member::Kind::radii, v, {}};
    throw std::invalid_argument("unknown member");
}

bool locate(const liftmesh::Question& question, liftmesh::Threads threads,
            liftmesh::Interrupt& interrupt) {
    const Input points{reinterpret_cast<const std::byte*>(question.points), question.rows,
                       sizeof(Point), sizeof(double), false};
    liftmesh::Locator locator({points, question.simplices, question.neighbors, question.count},
                              new_secret());
    return locator.find({reinterpret_cast<const double*>(question.queries), question.queried},
                        question.found, threads, interrupt);
}

nb::tuple verify(const PlanarRows& rows, const Triples& simplices, bool skip_non_finite,
                 unsigned threads, bool shared, nb::handle progress,
                 std::string_view name_of_member, const Numbers& values) {
    const Input input = read(rows);
    const Member member = member_named(name_of_member, values, input.rows);
    const liftmesh::Threads allowed{threads, shared};
    PythonInterrupt interrupt(progress);
    liftmesh::Verdict verdict;
    {
        const nb::gil_scoped_release unlocked;
        const auto ask = [&](const liftmesh::Question& question) {
            return locate(question, allowed, interrupt);
        };
        verdict = liftmesh::verify(input, simplices.data(), simplices.shape(0), skip_non_finite,
                                   member, ask, allowed, interrupt);
    }
    if (verdict.status == liftmesh::Status::interrupted) throw nb::python_error();
    return nb::make_tuple(name(verdict.status), verdict.row, verdict.skipped, verdict.vertices,
                          verdict.merged, verdict.hidden, verdict.interior_edges,
                          verdict.boundary_edges, as_list(verdict.flaws));
}

nb::tuple verify_part(const PlanarRows& rows, const Triples& simplices, unsigned threads,
                      bool shared) {
    const Input input = read(rows);
    const std::size_t corners = 3 * simplices.shape(0);
    if (std::any_of(simplices.data(), simplices.data() + corners, [&](std::int32_t corner) {
            return corner < 0 || static_cast<std::size_t>(corner) >= input.rows;
        }))
        throw std::invalid_argument("a corner is no row");
    PythonInterrupt interrupt;
    liftmesh::VerifiedPart part;
    {
        const nb::gil_scoped_release unlocked;
        part = liftmesh::verify_part(input, simplices.data(), simplices.shape(0), {threads, shared},
                                     interrupt);
    }
    if (!part.is_complete) throw nb::python_error();
    auto open = liftmesh::allocate<std::int32_t>(3 * part.open.size());
    for (std::size_t i = 0; i < part.open.size(); ++i) {
        const auto& [tail, head, apex] = part.open[i];
        open[3 * i] = tail, open[3 * i + 1] = head, open[3 * i + 2] = apex;
    }
    return nb::make_tuple(as_list(part.flaws), part.interior_edges,
                          adopt(std::move(open), part.open.size(), 3));
}

}  // namespace

void bind_verify(nb::module_& m) {
    m.def("verify", &verify, "rows"_a, "simplices"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none(), "member"_a, "values"_a);
    m.def("verify_part", &verify_part, "rows"_a, "simplices"_a, "threads"_a, "shared"_a);
}

}  // namespace bindings
