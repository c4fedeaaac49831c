#include "verify/sphere.hpp"

#include "predicates/ray_side.hpp"

namespace liftmesh {

namespace {

class SphereVerifier : SimplexVerifier {
 public:
    SphereVerifier(const SpaceOrder& points, std::size_t rows, const std::int32_t* simplices,
                   std::size_t count, ThreadPool& pool, SpaceVerdict& verdict)
        : SimplexVerifier(points, rows, simplices, count, 3, pool, verdict) {}

    // False if the interrupt came first.
    bool run() {
        if (!name_vertices() || !make_rays() || !check()) return false;
        const Flaws& flaws = verdict_.flaws;
        if (!flaws.any() || flaws.any(SpaceFlaw::invalid_index) || flaws.any(SpaceFlaw::non_finite))
            return true;
        bool are_merged = false;
        if (!merge_directions(are_merged)) return false;
        if (!are_merged) return true;
        verdict_.flaws = {};
        verdict_.facets = 0;
        return check();
    }

 private:
    bool make_rays() {
        rays_ = allocate<Ray>(points_.count);
        return in_blocks(points_.count, block, pool_,
                         [this](std::size_t v, std::size_t last, std::size_t) {
                             for (; v < last; ++v) rays_[v] = Ray(points_.points[v]);
                         });
    }

    bool check() {
        if (!check_corners()) return false;
        if (verdict_.flaws.any(SpaceFlaw::invalid_index) ||
            verdict_.flaws.any(SpaceFlaw::non_finite))
            return true;
        if (!find_missing()) return false;
        if (count_ == 0) return true;
        if (!choose_inner() || !check_triangles()) return false;
        return verdict_.flaws.any(SpaceFlaw::degenerate) || check_edges();
    }

    std::array<Vertex, 3> triangle(std::size_t t) const {
        return {corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)};
    }
    bool is_double(Vertex v, Vertex w) const {
        return v == w || have_one_direction(rays_[v], rays_[w]);
    }
    bool is_degenerate(std::size_t t) const {
        const auto [a, b, c] = triangle(t);
        return is_double(a, b) || is_double(b, c) || is_double(c, a);
    }

    // 1 if d is above the plane of the others, by the rule for ties.
    int side(Vertex a, Vertex b, Vertex c, Vertex d) const {
        if (d == a || d == b || d == c) return 0;
        return ray_side(rays_[a], rays_[b], rays_[c], rays_[d]);
    }
    bool is_tie(Vertex a, Vertex b, Vertex c, Vertex d) const {
        return ray_side_unperturbed(rays_[a], rays_[b], rays_[c], rays_[d]) == 0;
    }
    bool rises(Vertex a, Vertex b, Vertex c, Vertex d) const {
        return side(a, b, c, d) > 0 && (is_flat_ || !is_tie(a, b, c, d));
    }

    // The corners of the first triangle, and a vertex that is not on their circle, if there is one.
    bool choose_inner() {
        const auto [a, b, c] = triangle(0);
        inner_ = {a, b, c, a};
        is_flat_ = true;
        if (is_degenerate(0)) return true;
        Patience patience(interrupt_);
        for (Vertex v = 0; v < points_.count && is_flat_; ++v) {
            if (patience.ends()) return false;
            if (!is_vertex_[v] || is_double(v, a) || is_double(v, b) || is_double(v, c)) continue;
            is_flat_ = is_tie(a, b, c, v);
            if (!is_flat_ || inner_[3] == a) inner_[3] = v;
        }
        return true;
    }

    // Most are far below the plane, and then the triangle has three directions, too.
    bool check_triangles() {
        return for_each(count_, [this](std::size_t t, Found& found) {
            if (is_surely_right(t)) return;
            const auto [a, b, c] = triangle(t);
            if (is_degenerate(t)) found.flaws.add(SpaceFlaw::degenerate, {t, 0});
            for (Vertex v : inner_)
                if (rises(a, b, c, v)) found.flaws.add(SpaceFlaw::not_convex, {3 * t, 0});
        });
    }

    // With the bound of ray_side(), where the longest step is at most 2.
    bool is_surely_right(std::size_t t) const {
        constexpr double error = 4 * 80 * 0x1p-53;
        const SpacePoint &p = rays_[corner(3 * t)].unit, &q = rays_[corner(3 * t + 1)].unit,
                         &r = rays_[corner(3 * t + 2)].unit;
        const double qx = q.x - p.x, qy = q.y - p.y, qz = q.z - p.z;
        const double rx = r.x - p.x, ry = r.y - p.y, rz = r.z - p.z;
        const double x = qy * rz - qz * ry, y = qz * rx - qx * rz, z = qx * ry - qy * rx;
        return std::all_of(inner_.begin(), inner_.end(), [&](Vertex v) {
            const SpacePoint& s = rays_[v].unit;
            return (s.x - p.x) * x + (s.y - p.y) * y + (s.z - p.z) * z < -error;
        });
    }

    bool check_edges() {
        const auto corners = [this](std::size_t t) { return triangle(t); };
        const auto check = [this](std::size_t one, std::size_t other, Found& found) {
            check_edge(one, other, found);
        };
        if (!pair_edges(count_, corners, check)) return false;
        return verdict_.flaws.any(SpaceFlaw::non_manifold_edges) ||
               check_turn(
                   count_, corners, inner_[0],
                   [this](Vertex a, Vertex b, Vertex c, Vertex d) { return rises(a, b, c, d); });
    }

    void check_edge(std::size_t place, std::size_t other, Found& found) const {
        ++found.facets;
        const auto [a, b, c] = triangle(place / 3);
        const Vertex apex = corner(other);
        const bool is_double_face = apex == corner(place);
        if (side(a, b, c, apex) <= 0 && !is_double_face) return;
        const bool is_other_choice = !is_double_face && !is_flat_ && is_tie(a, b, c, apex);
        found.flaws.add(is_other_choice ? SpaceFlaw::not_canonical : SpaceFlaw::not_delaunay,
                        {std::min(place, other), std::max(place, other)});
    }

    // Positions of one direction become one vertex, that of the lowest row.
    bool merge_directions(bool& are_merged) {
        std::vector<Vertex> order(points_.count);
        std::iota(order.begin(), order.end(), Vertex{0});
        const auto is_before = [this](Vertex v, Vertex w) {
            return is_direction_before(at(v), at(w));
        };
        if (!patient_sort(order, is_before, interrupt_)) return false;
        std::vector<Vertex> chosen(points_.count);
        for (std::size_t i = 0, end; i < order.size(); i = end) {
            Vertex lowest = order[i];
            for (end = i + 1; end < order.size() && !is_before(order[i], order[end]); ++end)
                if (points_.rows[order[end]] < points_.rows[lowest]) lowest = order[end];
            for (std::size_t j = i; j < end; ++j) chosen[order[j]] = lowest;
            are_merged = are_merged || end > i + 1;
        }
        for (Vertex& v : vertex_of_)
            if (v != no_vertex) v = chosen[v];
        return true;
    }

    Buffer<Ray> rays_;
    std::array<Vertex, 4> inner_{};
    bool is_flat_ = false;
};

}  // namespace

SpaceVerdict verify_sphere(const Input& input, const std::int32_t* simplices, std::size_t count,
                           bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    return verify_in_space(
        input, skip_non_finite, threads, interrupt,
        [&](const SpaceOrder& points, ThreadPool& pool, SpaceVerdict& verdict) {
            return SphereVerifier(points, input.rows, simplices, count, pool, verdict).run();
        });
}

}  // namespace liftmesh
