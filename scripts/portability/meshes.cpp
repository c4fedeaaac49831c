#include "meshes.hpp"

#include <cmath>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "hull/lower_hull.hpp"
#include "paper/facet_search.hpp"
#include "rows.hpp"
#include "verify/verify.hpp"

namespace portability {

namespace {

using liftmesh::Delaunay;
using liftmesh::Input;
using liftmesh::Status;
using liftmesh::Threads;

constexpr std::size_t most_to_wrap = 100, most_in_space = 3000;

void add(Digest& digest, const liftmesh::Buffer<std::int32_t>& values, std::size_t count) {
    if (count > 0) digest.add(values.get(), count * sizeof(std::int32_t));
}

void add(Digests& digests, const Delaunay& found) {
    Digest& rest = digests.of["status and rows"];
    rest.add(found.status);
    rest.add(found.distinct);
    for (const liftmesh::Duplicate& pair : found.duplicates) {
        rest.add(pair.row);
        rest.add(pair.kept);
    }
    const liftmesh::Result& result = found.result;
    add(digests.of["simplices"], result.simplices, 3 * result.triangle_count);
    add(digests.of["neighbors"], result.neighbors, 3 * result.triangle_count);
    add(digests.of["hull"], result.hull, result.hull_count);
}

void add_located(const Input& input, const double* coordinates, const Delaunay& found,
                 Digest& digest) {
    std::vector<double> asked(coordinates, coordinates + 2 * input.rows);
    for (std::size_t i = 2; i < 2 * input.rows; ++i)
        asked.push_back(0.5 * coordinates[i - 2] + 0.5 * coordinates[i]);
    std::vector<std::int32_t> at(asked.size() / 2);
    liftmesh::Locator locator({input, found.result.simplices.get(), found.result.neighbors.get(),
                               found.result.triangle_count},
                              1);
    liftmesh::NoInterrupt never;
    demand(locator.find({asked.data(), at.size()}, at.data(), {}, never), "an interrupted search");
    digest.add(at.data(), at.size() * sizeof(std::int32_t));
}

void add_verified(const Input& input, const Delaunay& found, Digest& digest) {
    liftmesh::NoInterrupt never;
    const liftmesh::Verdict verdict = liftmesh::verify(
        input, found.result.simplices.get(), found.result.triangle_count, true, {}, never);
    demand(!verdict.flaws.any(), "the verifier finds flaws");
    digest.add(verdict.vertices);
    digest.add(verdict.interior_edges);
}

// The second coordinate of the next row is the height of a row.
void add_space(const double* coordinates, std::size_t rows, Digest& digest) {
    std::vector<double> values;
    for (std::size_t row = 0; row < rows; ++row)
        for (const std::size_t at : {2 * row, 2 * row + 1, 2 * ((row + 1) % rows) + 1})
            values.push_back(coordinates[at]);
    const Input input{reinterpret_cast<const std::byte*>(values.data()), rows, 3 * sizeof(double),
                      sizeof(double), false};
    liftmesh::NoInterrupt never;
    liftmesh::paper::Counts counts;
    const Delaunay found =
        liftmesh::lower_hull(input, liftmesh::HullMethod::incremental, 20, {}, never, counts);
    add(digest, found.result.simplices, 3 * found.result.triangle_count);
}

void add_wrapped(const Input& input, Digest& digest) {
    for (const auto procedure : {liftmesh::Procedure::lf, liftmesh::Procedure::lfres_indexed}) {
        liftmesh::NoInterrupt never;
        liftmesh::paper::Counts counts;
        const Delaunay found =
            liftmesh::wrap_delaunay(input, true, procedure, {0.1, 0.2}, {}, never, counts);
        add(digest, found.result.simplices, 3 * found.result.triangle_count);
        digest.add(counts.undecided);
    }
}

bool same(const Delaunay& a, const Delaunay& b) {
    Digests of_a, of_b;
    add(of_a, a);
    add(of_b, b);
    for (const auto& [what, digest] : of_a.of)
        if (digest.value() != of_b.of[what].value()) return false;
    return true;
}

}  // namespace

void add_meshes(const double* coordinates, std::size_t rows, Digests& digests) {
    const Input input = native::input_of(coordinates, rows);
    liftmesh::NoInterrupt never;
    const Delaunay found = liftmesh::delaunay(input, true, {}, never);
    const Threads three{3, false};
    if (three.for_rows(rows).limit > 1)
        demand(same(found, liftmesh::delaunay(input, true, three, never)), "threads differ");
    add(digests, found);
    if (rows <= most_in_space) add_space(coordinates, rows, digests.of["lower hull in space"]);
    if (rows <= most_to_wrap) add_wrapped(input, digests.of["gift wrapping"]);
    if (found.status != Status::ok) return;
    add_located(input, coordinates, found, digests.of["find_simplex"]);
    add_verified(input, found, digests.of["verify"]);
}

}  // namespace portability
