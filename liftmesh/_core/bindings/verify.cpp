// The Python interface of the verifier. Rows without a vertex are located by the index of
// `find_simplex`; the verifier checks its answers.

#include "verify/verify.hpp"

#include "bindings/python.hpp"
#include "delaunay/locate.hpp"

namespace bindings {

using liftmesh::Member;

namespace {

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

// In place of another member: pairs of rows, and whether regions that they bound may be missing.
Member constrained_by(const Array<const std::int32_t, 2>& edges, bool carved, std::size_t rows) {
    const std::int32_t* ends = edges.data();
    if (std::any_of(ends, ends + 2 * edges.shape(0),
                    [&](std::int32_t row) { return static_cast<std::size_t>(row) >= rows; }))
        throw std::invalid_argument("an end is no row");
    return {Member::Kind::constrained, nullptr, {}, {ends, edges.shape(0), carved}};
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
                 std::string_view name_of_member, const Numbers& values,
                 const std::optional<Array<const std::int32_t, 2>>& edges, bool carved) {
    const Input input = read(rows);
    const Member member = edges ? constrained_by(*edges, carved, input.rows)
                                : member_named(name_of_member, values, input.rows);
    const liftmesh::Threads allowed{threads, shared};
    auto verdict = unlocked(progress, [&](auto& interrupt) {
        const auto ask = [&](const liftmesh::Question& question) {
            return locate(question, allowed, interrupt);
        };
        return liftmesh::verify(input, simplices.data(), simplices.shape(0), skip_non_finite,
                                member, ask, allowed, interrupt);
    });
    raise_if(verdict.status == liftmesh::Status::interrupted);
    return nb::make_tuple(name(verdict.status), verdict.row, verdict.skipped, verdict.vertices,
                          verdict.merged, verdict.hidden, verdict.interior_edges,
                          verdict.boundary_edges, as_list(verdict.flaws), verdict.outside);
}

nb::tuple verify_part(const PlanarRows& rows, const Triples& simplices, unsigned threads,
                      bool shared) {
    const Input input = read(rows);
    const std::size_t corners = 3 * simplices.shape(0);
    if (std::any_of(simplices.data(), simplices.data() + corners, [&](std::int32_t corner) {
            return corner < 0 || static_cast<std::size_t>(corner) >= input.rows;
        }))
        throw std::invalid_argument("a corner is no row");
    auto part = unlocked(nb::none(), [&](auto& interrupt) {
        return liftmesh::verify_part(input, simplices.data(), simplices.shape(0), {threads, shared},
                                     interrupt);
    });
    raise_if(!part.is_complete);
    return nb::make_tuple(as_list(part.flaws), part.interior_edges,
                          array_of<std::int32_t>(part.open));
}

}  // namespace

void bind_verify(nb::module_& m) {
    m.def("verify", &verify, "rows"_a, "simplices"_a, "skip_non_finite"_a, "threads"_a, "shared"_a,
          "progress"_a.none(), "member"_a, "values"_a, "edges"_a = nb::none(), "carved"_a = false);
    m.def("verify_part", &verify_part, "rows"_a, "simplices"_a, "threads"_a, "shared"_a);
}

}  // namespace bindings
