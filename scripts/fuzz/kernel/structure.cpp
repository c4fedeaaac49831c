#include "structure.hpp"

#include <algorithm>
#include <cstring>

#include "demand.hpp"
#include "exact.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"

namespace fuzzing {

namespace {

using liftmesh::Result;

// Large cases use the kernel's predicates, which small cases compare with `exact.hpp`.
int turn_in(const Case& c, std::int32_t i, std::int32_t j, std::int32_t k) {
    const auto at = [&](std::int32_t row) { return c.point(static_cast<std::size_t>(row)); };
    return c.is_large() ? liftmesh::orient2d(at(i), at(j), at(k)) : turn(at(i), at(j), at(k));
}

int incircle_in(const Case& c, std::int32_t i, std::int32_t j, std::int32_t k, std::int32_t l) {
    const auto at = [&](std::int32_t row) { return c.point(static_cast<std::size_t>(row)); };
    if (!c.is_large()) return incircle(at(i), at(j), at(k), at(l), true);
    const auto guard = liftmesh::Guard::anywhere();
    return liftmesh::incircle_canonical_exact(at(i), at(j), at(k), at(l), guard);
}

class Walk {
 public:
    Walk(const Case& c, const Result& result) : c_(c), r_(result) {}

    std::size_t count() const { return r_.triangle_count; }
    std::int32_t corner(std::size_t t, std::size_t k) const { return r_.simplices[3 * t + k % 3]; }
    std::int32_t neighbor(std::size_t t, std::size_t k) const { return r_.neighbors[3 * t + k]; }

    // The corner of t's neighbour across edge k that is opposite that edge.
    std::size_t facing(std::size_t t, std::size_t k) const {
        demand(neighbor(t, k) >= 0 && neighbor(t, k) < static_cast<std::int32_t>(count()),
               "a neighbour is not a triangle");
        const auto u = static_cast<std::size_t>(neighbor(t, k));
        for (std::size_t j = 0; j < 3; ++j)
            if (corner(u, j + 1) == corner(t, k + 2) && corner(u, j + 2) == corner(t, k + 1)) {
                demand(neighbor(u, j) == static_cast<std::int32_t>(t), "a neighbour has another");
                return j;
            }
        demand(false, "neighbours share no edge");
        return 0;
    }

    // Checks that corners are among `rows`, and returns those that are corners.
    Rows check_corners(const Rows& rows) const {
        std::vector<bool> used(c_.rows()), allowed(c_.rows());
        for (const liftmesh::Row row : rows) allowed[row] = true;
        for (std::size_t i = 0; i < 3 * count(); ++i) {
            const std::int32_t row = r_.simplices[i];
            demand(row >= 0 && row < static_cast<std::int32_t>(c_.rows()), "a corner is not a row");
            demand(allowed[static_cast<std::size_t>(row)],
                   "a corner is a row that another represents");
            used[static_cast<std::size_t>(row)] = true;
        }
        Rows result;
        for (const liftmesh::Row row : rows)
            if (used[row]) result.push_back(row);
        return result;
    }

    void check_turns() const {
        for (std::size_t t = 0; t < count(); ++t)
            demand(turn_in(c_, corner(t, 0), corner(t, 1), corner(t, 2)) > 0,
                   "a triangle is not counter-clockwise");
    }

    // Neighbours are mutual, and the boundary is one closed curve, the hull.
    void check_boundary() const {
        std::vector<std::int32_t> next(c_.rows(), -1);
        std::size_t edges = 0;
        for (std::size_t t = 0; t < count(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                if (neighbor(t, k) != -1) {
                    facing(t, k);
                    continue;
                }
                std::int32_t& head = next[static_cast<std::size_t>(corner(t, k + 1))];
                demand(head == -1, "the boundary visits a vertex twice");
                head = corner(t, k + 2);
                ++edges;
            }
        demand(edges == r_.hull_count, "the hull and the boundary differ in length");
        for (std::size_t i = 0; i < edges; ++i)
            demand(next[static_cast<std::size_t>(r_.hull[i])] == r_.hull[(i + 1) % edges],
                   "the hull is not the boundary");
    }

    void check_hull() const {
        const std::size_t n = r_.hull_count;
        for (std::size_t i = 0; i < n; ++i)
            demand(turn_in(c_, r_.hull[i], r_.hull[(i + 1) % n], r_.hull[(i + 2) % n]) >= 0,
                   "the hull is not convex");
        const auto position = [&](std::int32_t row) {
            return c_.point(static_cast<std::size_t>(row));
        };
        for (std::size_t i = 1; i < n; ++i)
            demand(liftmesh::before_xy(position(r_.hull[0]), position(r_.hull[i])),
                   "the hull does not begin at its least point");
    }

 private:
    const Case& c_;
    const Result& r_;
};

}  // namespace

Rows check_structure(const Case& c, const Result& result, const Rows& rows) {
    const Walk walk(c, result);
    Rows corners = walk.check_corners(rows);
    walk.check_turns();
    walk.check_boundary();
    walk.check_hull();
    demand(result.triangle_count + result.hull_count + 2 == 2 * corners.size(),
           "the number of triangles violates Euler's relation");
    return corners;
}

void check_delaunay(const Case& c, const Result& result, const std::uint8_t* marks) {
    const Walk walk(c, result);
    for (std::size_t t = 0; t < walk.count(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t u = walk.neighbor(t, k);
            const bool is_marked = marks != nullptr && (marks[t] >> k & 1) != 0;
            if (u < static_cast<std::int32_t>(t) || is_marked) continue;
            const std::int32_t apex = walk.corner(static_cast<std::size_t>(u), walk.facing(t, k));
            demand(
                incircle_in(c, walk.corner(t, 0), walk.corner(t, 1), walk.corner(t, 2), apex) < 0,
                "an edge is not Delaunay, or not canonical");
        }
}

void check_lower(const Case& c, const Result& result, const Rows& rows) {
    const auto at = [&](std::int32_t row) { return c.points[static_cast<std::size_t>(row)]; };
    for (std::size_t t = 0; t < result.triangle_count; ++t) {
        const std::int32_t* corner = &result.simplices[3 * t];
        for (const liftmesh::Row row : rows) {
            if (std::count(corner, corner + 3, static_cast<std::int32_t>(row)) > 0) continue;
            demand(orient3d(at(corner[0]), at(corner[1]), at(corner[2]), c.points[row], true) < 0,
                   "a row is below a facet of the lower hull");
        }
    }
}

std::vector<Triangle> triangles(const Result& result) {
    std::vector<Triangle> all(result.triangle_count);
    for (std::size_t t = 0; t < all.size(); ++t) {
        std::copy_n(&result.simplices[3 * t], 3, all[t].begin());
        std::rotate(all[t].begin(), std::min_element(all[t].begin(), all[t].end()), all[t].end());
    }
    std::sort(all.begin(), all.end());
    return all;
}

bool same_bits(const Result& a, const Result& b) {
    if (a.triangle_count != b.triangle_count || a.hull_count != b.hull_count) return false;
    const std::size_t bytes = 3 * a.triangle_count * sizeof(std::int32_t);
    return std::memcmp(a.simplices.get(), b.simplices.get(), bytes) == 0 &&
           std::memcmp(a.neighbors.get(), b.neighbors.get(), bytes) == 0 &&
           std::memcmp(a.hull.get(), b.hull.get(), a.hull_count * sizeof(std::int32_t)) == 0;
}

}  // namespace fuzzing
