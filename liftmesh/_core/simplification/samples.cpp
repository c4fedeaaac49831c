#include "simplification/samples.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "predicates/lattice.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/hilbert.hpp"

namespace liftmesh::simplification {

std::vector<Sample> samples_of(const Terrain& terrain) {
    Bounds box = Bounds::nothing();
    for (std::size_t i = 0; i < terrain.count; ++i) box.add(pair(terrain.points[i]));
    const HilbertCurve curve(box);
    std::vector<Sample> samples(terrain.count);
    for (std::size_t i = 0; i < terrain.count; ++i) {
        const Point p = terrain.points[i];
        samples[i] = {p, terrain.heights[i], static_cast<Row>(i), curve(p)};
    }
    std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
        return std::tie(a.next, a.point.x, a.point.y) < std::tie(b.next, b.point.x, b.point.y);
    });
    for (Sample& each : samples) each.next = none;
    return samples;
}

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

Turns::Turns(const Terrain& terrain) {
    int lowest = std::numeric_limits<int>::max();
    Bounds box = Bounds::nothing();
    for (std::size_t i = 0; i < terrain.count; ++i) {
        const Point p = terrain.points[i];
        box.add(pair(p));
        for (const double each : {p.x, p.y})
            if (each != 0) lowest = std::min(lowest, dyadic(each).exponent);
    }
    const Pair size = box.high - box.low;
    const double range = std::max(size[0], size[1]);
    is_exact_ = lowest > -900 && lowest < 900 && range < std::ldexp(1.0, lowest + 26);
}

}  // namespace liftmesh::simplification
