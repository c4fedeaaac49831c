#include "sorting/halving.hpp"

#include <algorithm>

#include "sorting/bounds.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t few = 8;

template <class Precedes>
std::size_t halve_few(Site* sites, std::size_t count, Precedes precedes) {
    std::size_t rank[few] = {};
    for (std::size_t j = 1; j < count; ++j) {
        for (std::size_t i = 0; i < j; ++i) {
            const bool ahead = precedes(sites[i].point, sites[j].point);
            rank[j] += ahead;
            rank[i] += !ahead;
        }
    }
    Site sorted[few];
    for (std::size_t i = 0; i < count; ++i) sorted[rank[i]] = sites[i];
    std::copy_n(sorted, count, sites);
    return count / 2;
}

Point least(Point p, Point q) {
    return {std::min(p.x, q.x), std::min(p.y, q.y)};
}
Point greatest(Point p, Point q) {
    return {std::max(p.x, q.x), std::max(p.y, q.y)};
}
Point median(Point p, Point q, Point r) {
    return greatest(least(p, q), least(greatest(p, q), r));
}

// Estimates from nine evenly spaced sites: Tukey's ninther of each coordinate (where many points
// share one, the other decides), and the bounds.
struct Sample {
    Point near_middle;
    Bounds bounds;
};

Sample sample(const Site* sites, std::size_t count) {
    Point nine[9];
    Bounds bounds(sites[0].point);
    for (std::size_t k = 0; k < 9; ++k) bounds.add(nine[k] = sites[k * (count / 9)].point);
    const auto of_three = [&](int k) { return median(nine[k], nine[k + 3], nine[k + 6]); };
    return {median(of_three(0), of_three(1), of_three(2)), bounds};
}

Bounds bounds_of(const Site* sites, std::size_t count) {
    Bounds bounds(sites[0].point);
    for (std::size_t i = 1; i < count; ++i) bounds.add(sites[i].point);
    return bounds;
}

template <class Precedes>
std::size_t partition(Site* sites, std::size_t count, Point pivot, Precedes precedes) {
    std::size_t middle = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Site site = sites[i];
        sites[i] = sites[middle];
        sites[middle] = site;
        middle += precedes(site.point, pivot);
    }
    return middle;
}

template <class Precedes>
std::size_t halve_many(Site* sites, std::size_t count, Point pivot, Precedes precedes) {
    const std::size_t middle = partition(sites, count, pivot, precedes);
    if (std::min(middle, count - middle) >= count / 8 + 1) return middle;
    std::nth_element(sites, sites + count / 2, sites + count,
                     [&](const Site& a, const Site& b) { return precedes(a.point, b.point); });
    return count / 2;
}

constexpr auto by_x = [](Point p, Point q) { return before_xy(p, q); };
constexpr auto by_y = [](Point p, Point q) { return before_yx(p, q); };

}  // namespace

Halving halve(Site* sites, std::size_t count) {
    if (count <= few) {
        const Axis axis = bounds_of(sites, count).longer();
        return {axis,
                axis == Axis::x ? halve_few(sites, count, by_x) : halve_few(sites, count, by_y)};
    }
    const Sample some = sample(sites, count);
    const Axis axis = some.bounds.longer();
    return {axis, axis == Axis::x ? halve_many(sites, count, some.near_middle, by_x)
                                  : halve_many(sites, count, some.near_middle, by_y)};
}

}  // namespace liftmesh
