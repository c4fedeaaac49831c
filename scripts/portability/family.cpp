#include "family.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "rows.hpp"
#include "verify/verify.hpp"

namespace portability {

namespace {

using liftmesh::Input;
using liftmesh::Member;
using liftmesh::Regular;
using liftmesh::Status;
using liftmesh::Threads;

constexpr liftmesh::ByMetric metric{2, 0.5, 1.25};
constexpr Threads three{3, false};

// Weights and radii of the size at which about half of the rows are hidden where points are spread
// evenly: from products and quotients alone, which are the same everywhere.
std::vector<double> values_of(const double* coordinates, std::size_t rows, bool are_radii) {
    double least = 0, most = 0;
    for (std::size_t i = 0; i < 2 * rows; ++i) {
        if (!std::isfinite(coordinates[i])) continue;
        least = std::min(least, coordinates[i]);
        most = std::max(most, coordinates[i]);
    }
    const double side = (most - least) / std::sqrt(static_cast<double>(rows)) * 2;
    const double unit = std::min(are_radii ? side : side * side, 0x1p1000);
    std::vector<double> values;
    for (std::size_t i = 0; i < rows; ++i) {
        const double value = static_cast<double>(i * 2654435761 % 4096) / 4096 * unit;
        values.push_back(i % 5 == 0 ? 0 : value);
    }
    return values;
}

void add_all(Digest& digest, const liftmesh::Buffer<std::int32_t>& values, std::size_t count) {
    if (count > 0) digest.add(values.get(), count * sizeof(std::int32_t));
}

Digest digest_of(const Regular& found) {
    Digest digest;
    digest.add(found.status);
    for (const auto* rows : {&found.hidden, &found.skipped})
        for (const liftmesh::Row row : *rows) digest.add(row);
    for (const liftmesh::Duplicate& pair : found.duplicates) {
        digest.add(pair.row);
        digest.add(pair.kept);
    }
    add_all(digest, found.result.simplices, 3 * found.result.triangle_count);
    add_all(digest, found.result.neighbors, 3 * found.result.triangle_count);
    add_all(digest, found.result.hull, found.result.hull_count);
    return digest;
}

void add_verified(const Input& input, const Member& member, const Regular& found, Digest& digest) {
    liftmesh::NoInterrupt never;
    const auto locate = [&](const liftmesh::Question& q) {
        liftmesh::Locator locator(
            {native::input_of(&q.points->x, q.rows), q.simplices, q.neighbors, q.count}, 1);
        return locator.find({reinterpret_cast<const double*>(q.queries), q.queried}, q.found, {},
                            never);
    };
    const liftmesh::Verdict verdict =
        liftmesh::verify(input, found.result.simplices.get(), found.result.triangle_count, true,
                         member, locate, {}, never);
    demand(verdict.status == Status::ok && !verdict.flaws.any(), "the verifier finds flaws");
    digest.add(verdict.hidden);
    digest.add(verdict.interior_edges);
}

template <class Run>
void add(const std::string& name, const Input& input, const Member& member, Run run,
         Digests& digests) {
    const Regular found = run(Threads{});
    const Digest digest = digest_of(found);
    if (three.for_rows(input.rows).limit > 1)
        demand(digest_of(run(three)).value() == digest.value(), "threads differ");
    digests.of[name].add(digest.value());
    digests.of[name].add(found.hidden.size());
    if (found.status == Status::ok) add_verified(input, member, found, digests.of[name]);
}

}  // namespace

void add_family(const double* coordinates, std::size_t rows, Digests& digests) {
    const Input input = native::input_of(coordinates, rows);
    liftmesh::NoInterrupt never;
    for (const bool are_radii : {false, true}) {
        const std::vector<double> values = values_of(coordinates, rows, are_radii);
        const liftmesh::Values given{reinterpret_cast<const std::byte*>(values.data()),
                                     sizeof(double), false, are_radii};
        const auto kind = are_radii ? Member::Kind::radii : Member::Kind::weights;
        const auto run = [&](Threads threads) {
            return liftmesh::regular(input, given, true, threads, never);
        };
        add(are_radii ? "radii" : "weights", input, {kind, values.data(), metric}, run, digests);
    }
    const auto in_metric = [&](Threads threads) {
        return Regular{liftmesh::delaunay(metric, input, true, threads, never), {}};
    };
    add("metric", input, {Member::Kind::metric, nullptr, metric}, in_metric, digests);
    const auto farthest = [&](Threads threads) {
        return liftmesh::farthest(input, true, threads, never);
    };
    add("farthest", input, {Member::Kind::farthest, nullptr, metric}, farthest, digests);
}

}  // namespace portability
