#include "halving.hpp"

#include <algorithm>

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

// Tukey's ninther of each coordinate: where many points share one, the other decides.
Point near_middle(const Site* sites, std::size_t count) {
    const std::size_t step = count / 9;
    const auto of_three = [&](std::size_t k) {
        return median(sites[k * step].point, sites[(k + 3) * step].point,
                      sites[(k + 6) * step].point);
    };
    return median(of_three(0), of_three(1), of_three(2));
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
std::size_t halve_by(Site* sites, std::size_t count, Precedes precedes) {
    if (count <= few) return halve_few(sites, count, precedes);
    const std::size_t middle = partition(sites, count, near_middle(sites, count), precedes);
    if (std::min(middle, count - middle) >= count / 8 + 1) return middle;
    std::nth_element(sites, sites + count / 2, sites + count,
                     [&](const Site& a, const Site& b) { return precedes(a.point, b.point); });
    return count / 2;
}

}  // namespace

std::size_t halve(Site* sites, std::size_t count, Axis axis) {
    if (axis == Axis::x)
        return halve_by(sites, count, [](Point p, Point q) { return before_xy(p, q); });
    return halve_by(sites, count, [](Point p, Point q) { return before_yx(p, q); });
}

}  // namespace liftmesh
