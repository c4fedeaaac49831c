#include "simplification/samples.hpp"

#include "base/pair.hpp"
#include "predicates/lattice.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::simplification {

std::vector<Row> corners_of(const Terrain& terrain) {
    const auto at = [&](std::size_t i) {
        return static_cast<Row>(terrain.hull[i % terrain.hull_count]);
    };
    std::vector<Row> corners;
    for (std::size_t i = 0; i < terrain.hull_count; ++i) {
        const Point before = terrain.points[at(i + terrain.hull_count - 1)];
        if (orient2d(before, terrain.points[at(i)], terrain.points[at(i + 1)]) != 0)
            corners.push_back(at(i));
    }
    const auto is_less = [&](Row a, Row b) {
        return before_xy(terrain.points[a], terrain.points[b]);
    };
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), is_less),
                corners.end());
    return corners;
}

Skeleton skeleton_of(const Terrain& terrain) {
    Skeleton found{corners_of(terrain), {}};
    if (terrain.edge_count == 0) return found;
    constexpr auto absent = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> place(terrain.count, absent);
    const auto take = [&](Row row) {
        if (place[row] != absent) return;
        place[row] = found.rows.size();
        found.rows.push_back(row);
    };
    const std::vector<Row> corners = std::move(found.rows);
    std::vector<Row> ends(terrain.edges, terrain.edges + 2 * terrain.edge_count);
    std::sort(ends.begin(), ends.end(),
              [&](Row a, Row b) { return before_xy(terrain.points[a], terrain.points[b]); });
    found.rows.clear();
    for (const Row row : corners) take(row);
    for (const Row row : ends) take(row);
    for (std::size_t i = 0; i < terrain.edge_count; ++i)
        found.edges.push_back(std::minmax(place[static_cast<Row>(terrain.edges[2 * i])],
                                          place[static_cast<Row>(terrain.edges[2 * i + 1])]));
    std::sort(found.edges.begin(), found.edges.end(), [](const auto& one, const auto& other) {
        const auto drawn = [](const auto& edge) { return hash(edge.first << 32 | edge.second); };
        return std::pair(drawn(one), one) < std::pair(drawn(other), other);
    });
    return found;
}

void Steps::refine(double value) {
    if (value != 0) exponent_ = std::min(exponent_, dyadic(value).exponent);
}

void Steps::add(double value) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    refine(value);
}

void Steps::add_size(double value) {
    size_ = std::max(size_, value);
    refine(value);
}

// Too many if a product of three numbers might overflow, or one of three steps underflow.
int Steps::bits() const {
    constexpr int too_many = 4096, largest = 300;
    const double range = std::max(high_ - low_, size_);
    if (range == 0) return 0;
    if (exponent_ < -largest || !(range < std::ldexp(1, largest))) return too_many;
    return std::ilogb(range) + 1 - exponent_;
}

Turns::Turns(const Terrain& terrain) {
    Steps x, y;
    for (std::size_t i = 0; i < terrain.count; ++i) {
        x.add(terrain.points[i].x);
        y.add(terrain.points[i].y);
    }
    bits_ = std::max(x.bits(), y.bits());
}

Turns::Turns(const std::vector<double>& xs, const std::vector<double>& ys) {
    Steps x, y;
    for (const double each : xs) x.add(each);
    for (const double each : ys) y.add(each);
    bits_ = std::max(x.bits(), y.bits());
}

// Products of two coordinates and a height, and their sums in facet.hpp, are exact.
Tolerance::Tolerance(const Terrain& terrain, const Turns& turns, double tolerance)
    : value(tolerance) {
    constexpr std::size_t asking_every = 1024;
    Steps heights;
    heights.add_size(tolerance);
    is_exact = true;
    for (std::size_t i = 0; i < terrain.count && is_exact; ++i) {
        heights.add(terrain.heights[i]);
        if (i % asking_every == 0 || i + 1 == terrain.count)
            is_exact = 2 * turns.bits() + heights.bits() + 3 <= 53;
    }
}

}  // namespace liftmesh::simplification
