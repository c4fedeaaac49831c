// The verifier: yes to the triangulation, no to any that is damaged.

#include <algorithm>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "verify/verify.hpp"

namespace fuzzing {

namespace {

using liftmesh::Flaw;
using liftmesh::Verdict;
using Corners = std::vector<std::int32_t>;

Verdict verdict(const Case& c, const Corners& corners, liftmesh::Threads threads) {
    Impatient interrupt;
    return liftmesh::verify(c.input, corners.data(), corners.size() / 3, c.skip_non_finite, threads,
                            interrupt);
}

bool has_flaw(const Verdict& verdict) {
    for (unsigned flaw = 0; flaw < static_cast<unsigned>(Flaw::kinds); ++flaw)
        if (verdict.flaws[static_cast<Flaw>(flaw)].count() > 0) return true;
    return false;
}

// Exchanges the diagonal of two neighbours.
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

// Changes the set of triangles.
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

bool same_triangles(const Corners& a, const liftmesh::Result& b) {
    return a.size() == 3 * b.triangle_count && std::equal(a.begin(), a.end(), b.simplices.get());
}

}  // namespace

void check_verification(Case& c, const liftmesh::Delaunay& found) {
    const liftmesh::Result& result = found.result;
    Corners corners(result.simplices.get(), result.simplices.get() + 3 * result.triangle_count);
    const Verdict whole = verdict(c, corners, c.threads);
    demand(whole.status == liftmesh::Status::ok, "the verifier comes to another status");
    demand(!has_flaw(whole), "the verifier refuses the triangulation");
    demand(whole.vertices == found.distinct, "the verifier counts other vertices");
    demand(whole.border == result.hull_count, "the verifier counts other edges of the border");
    for (int round = 0; round < 4; ++round) {
        Corners damaged = corners;
        damage(c, found, damaged);
        if (same_triangles(damaged, result)) continue;
        demand(has_flaw(verdict(c, damaged, c.threads)),
               "the verifier accepts a damaged triangulation");
    }
}

}  // namespace fuzzing
