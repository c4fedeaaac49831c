// The verifier accepts the triangulation, rejects any damaged one, and finds the same flaws for any
// order of triangles, for triangles that share no rows, and for a mesh reversed as a whole.

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "verify/verify.hpp"

namespace fuzzing {

namespace {

using liftmesh::Flaw;
using liftmesh::Input;
using liftmesh::Verdict;

// The count of each kind of flaw.
using FlawCounts = std::array<std::size_t, static_cast<std::size_t>(Flaw::kinds)>;

Verdict verdict(const Case& c, const Input& input, const Corners& corners) {
    Impatient interrupt;
    return liftmesh::verify(input, corners.data(), corners.size() / 3, c.skip_non_finite, c.threads,
                            interrupt);
}

FlawCounts counts(const Verdict& verdict) {
    FlawCounts result{};
    for (std::size_t flaw = 0; flaw < result.size(); ++flaw)
        result[flaw] = verdict.flaws[static_cast<Flaw>(flaw)].count();
    return result;
}

bool same(const Verdict& a, const Verdict& b) {
    return counts(a) == counts(b) && a.interior_edges == b.interior_edges &&
           a.boundary_edges == b.boundary_edges && a.vertices == b.vertices;
}

void check_shuffled(Case& c, Corners corners, const Verdict& expected) {
    for (std::size_t left = corners.size() / 3; left > 1; --left) {
        const std::size_t one = 3 * (left - 1), other = 3 * c.dice.below(left);
        if (one != other) std::swap_ranges(&corners[one], &corners[one] + 3, &corners[other]);
    }
    demand(same(verdict(c, c.input, corners), expected), "the order of triangles matters");
}

// The points of each triangle, then all points.
void check_unshared(const Case& c, const Corners& corners, const Verdict& expected) {
    std::vector<liftmesh::Point> points;
    for (const std::int32_t row : corners) points.push_back(c.point(static_cast<std::size_t>(row)));
    for (std::size_t row = 0; row < c.rows(); ++row) points.push_back(c.point(row));
    const Input input{reinterpret_cast<const std::byte*>(points.data()), points.size(),
                      sizeof(liftmesh::Point), sizeof(double), false};
    Corners own(corners.size());
    std::iota(own.begin(), own.end(), 0);
    demand(same(verdict(c, input, own), expected), "triangles that share no rows have other flaws");
}

void check_reversed(const Case& c, Corners corners, const Verdict& expected) {
    if (expected.flaws.any(Flaw::clockwise)) return;
    for (std::size_t first = 0; first < corners.size(); first += 3)
        std::swap(corners[first], corners[first + 1]);
    FlawCounts wanted = counts(expected);
    wanted[static_cast<std::size_t>(Flaw::clockwise)] =
        corners.size() / 3 - expected.flaws[Flaw::degenerate].count();
    demand(counts(verdict(c, c.input, corners)) == wanted, "a reversed mesh has other flaws");
}

void check_variants(Case& c, const Corners& corners, const Verdict& expected) {
    check_shuffled(c, corners, expected);
    check_unshared(c, corners, expected);
    check_reversed(c, corners, expected);
}

// Flips the edge between two neighbours, or removes a triangle where there is none.
void flip(const liftmesh::Result& result, std::size_t t, std::size_t k, Corners& corners) {
    const std::int32_t u = result.neighbors[3 * t + k];
    if (u < 0) return corners.resize(corners.size() - 3);
    const auto place = 3 * static_cast<std::size_t>(u);
    const std::int32_t a = corners[3 * t + k], b = corners[3 * t + (k + 1) % 3],
                       c = corners[3 * t + (k + 2) % 3];
    const auto is_far = [&](std::int32_t row) { return row != b && row != c; };
    const std::int32_t d = *std::find_if(&corners[place], &corners[place] + 3, is_far);
    std::copy_n(std::array{a, b, d}.begin(), 3, &corners[3 * t]);
    std::copy_n(std::array{a, d, c}.begin(), 3, &corners[place]);
}

bool same_triangles(const Corners& a, const liftmesh::Result& b) {
    return a.size() == 3 * b.triangle_count && std::equal(a.begin(), a.end(), b.simplices.get());
}

}  // namespace

void damage(Case& c, const liftmesh::Delaunay& found, Corners& corners) {
    const std::size_t t = c.dice.below(found.result.triangle_count), k = c.dice.below(3);
    std::int32_t* const triangle = &corners[3 * t];
    switch (c.dice.below(5)) {
        case 0:
            return flip(found.result, t, k, corners);
        case 1:
            return std::swap(triangle[0], triangle[1]);
        case 2:
            corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(3 * t),
                          corners.begin() + static_cast<std::ptrdiff_t>(3 * t + 3));
            return;
        case 3: {
            const Corners again(triangle, triangle + 3);
            corners.insert(corners.end(), again.begin(), again.end());
            return;
        }
        default:
            triangle[k] = found.result.simplices[c.dice.below(3 * found.result.triangle_count)];
    }
}

void check_verification(Case& c, const liftmesh::Delaunay& found) {
    const liftmesh::Result& result = found.result;
    Corners corners(result.simplices.get(), result.simplices.get() + 3 * result.triangle_count);
    const Verdict whole = verdict(c, c.input, corners);
    demand(whole.status == liftmesh::Status::ok, "the verifier has another status");
    demand(!whole.flaws.any(), "the verifier rejects the triangulation");
    demand(whole.vertices == found.distinct, "the verifier counts other vertices");
    demand(whole.boundary_edges == result.hull_count, "the verifier counts other boundary edges");
    check_variants(c, corners, whole);
    for (int round = 0; round < 4; ++round) {
        Corners damaged = corners;
        damage(c, found, damaged);
        if (same_triangles(damaged, result)) continue;
        const Verdict rejected = verdict(c, c.input, damaged);
        demand(rejected.flaws.any(), "the verifier accepts a damaged triangulation");
        if (!damaged.empty()) check_variants(c, damaged, rejected);
    }
}

}  // namespace fuzzing
