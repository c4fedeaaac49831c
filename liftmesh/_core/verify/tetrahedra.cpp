#include "verify/tetrahedra.hpp"

namespace liftmesh {

namespace {

// The corners of facet k of a positive tetrahedron, counter-clockwise seen from outside.
constexpr unsigned outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

class TetrahedraVerifier : SimplexVerifier {
 public:
    TetrahedraVerifier(const SpaceOrder& points, std::size_t rows, const std::int32_t* simplices,
                       std::size_t count, ThreadPool& pool, SpaceVerdict& verdict)
        : SimplexVerifier(points, rows, simplices, count, 4, pool, verdict) {}

    // False if the interrupt came first.
    bool run() {
        if (!name_vertices() || !check_corners()) return false;
        if (verdict_.flaws.any()) return true;
        if (!check_volumes() || !check_facets()) return false;
        verdict_.hull_facets = boundary_.size();
        return check_boundary() && find_missing();
    }

 private:
    int side(Vertex a, Vertex b, Vertex c, Vertex d) const {
        return volume_sign(at(a), at(b), at(c), at(d), points_.trust);
    }

    bool check_volumes() {
        return for_each(count_, [this](std::size_t t, Found& found) {
            const std::size_t first = 4 * t;
            const int sign =
                side(corner(first), corner(first + 1), corner(first + 2), corner(first + 3));
            if (sign <= 0)
                found.flaws.add(sign < 0 ? SpaceFlaw::negative : SpaceFlaw::degenerate, {t, 0});
        });
    }

    std::array<Vertex, 3> facet(std::size_t place) const {
        const auto& k = outward[place % 4];
        const std::size_t first = place - place % 4;
        return {corner(first + k[0]), corner(first + k[1]), corner(first + k[2])};
    }

    bool check_facets() {
        const bool is_solid =
            !verdict_.flaws.any(SpaceFlaw::negative) && !verdict_.flaws.any(SpaceFlaw::degenerate);
        return pair_facets(
                   4 * count_, [this](std::size_t place) { return facet(place); },
                   [&](Vertex, std::span<const FacetOfSimplex> same, Found& found) {
                       check_same(same, is_solid, found);
                   }) &&
               patient_sort(boundary_, std::less<>(), interrupt_);
    }

    void check_same(std::span<const FacetOfSimplex> same, bool is_solid, Found& found) const {
        ++found.facets;
        for (std::size_t i = 1; i < same.size(); ++i)
            if (same[i].is_odd == same[i - 1].is_odd)
                found.flaws.add(SpaceFlaw::non_manifold_facets, {same[i].place, same[i - 1].place});
        if (same.size() == 1)
            found.boundary.push_back(same.front().place);
        else if (is_solid && same.front().is_odd != same.back().is_odd)
            check_sphere(same.front().place, same.back().place, found.flaws);
    }

    void check_sphere(std::size_t place, std::size_t other, Flaws& flaws) const {
        const std::size_t first = place - place % 4;
        const SpacePoint five[5] = {at(corner(first)), at(corner(first + 1)), at(corner(first + 2)),
                                    at(corner(first + 3)), at(corner(other))};
        const auto& [a, b, c, d, e] = five;
        if (!is_inside_sphere(a, b, c, d, e, points_.trust)) return;
        const bool is_tie = insphere_exact(five, points_.trust) == 0;
        flaws.add(is_tie ? SpaceFlaw::not_canonical : SpaceFlaw::not_delaunay,
                  {std::min(place, other), std::max(place, other)});
    }

    bool check_boundary() {
        if (boundary_.empty()) return true;
        const auto triangle = [this](std::size_t i) { return facet(boundary_[i]); };
        const auto rises = [this](Vertex a, Vertex b, Vertex c, Vertex d) {
            return side(a, b, c, d) > 0;
        };
        const Vertex u = largest_of_boundary();
        const auto check_inside = [&](std::size_t i, Found& found) {
            const auto [a, b, c] = triangle(i);
            for (Vertex v : {corner(0), corner(1), corner(2), corner(3), u})
                if (rises(a, b, c, v)) found.flaws.add(SpaceFlaw::not_convex, {boundary_[i], 0});
        };
        const auto check_edge = [&](std::size_t one, std::size_t other, Found& found) {
            const auto [a, b, c] = triangle(one / 3);
            if (rises(a, b, c, triangle(other / 3)[other % 3]))
                found.flaws.add(SpaceFlaw::not_convex, {boundary_[one / 3], 0});
        };
        if (!for_each(boundary_.size(), check_inside) ||
            !pair_edges(boundary_.size(), triangle, check_edge))
            return false;
        return verdict_.flaws.any(SpaceFlaw::non_manifold_edges) ||
               check_turn(boundary_.size(), triangle, u, rises);
    }

    Vertex largest_of_boundary() const {
        Vertex largest = facet(boundary_.front())[0];
        for (std::size_t place : boundary_)
            for (Vertex v : facet(place))
                if (before_xyz(at(largest), at(v))) largest = v;
        return largest;
    }
};

}  // namespace

SpaceVerdict verify_tetrahedra(const Input& input, const std::int32_t* simplices, std::size_t count,
                               bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    return verify_in_space(
        input, skip_non_finite, threads, interrupt,
        [&](const SpaceOrder& points, ThreadPool& pool, SpaceVerdict& verdict) {
            return TetrahedraVerifier(points, input.rows, simplices, count, pool, verdict).run();
        });
}

}  // namespace liftmesh
