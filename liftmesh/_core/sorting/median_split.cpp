#include "base/pair.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t few = 8;

Bounds bounds_of(const Site* sites, std::size_t count) {
    Bounds bounds(pair(sites[0].point));
    for (std::size_t i = 1; i < count; ++i) bounds.add(pair(sites[i].point));
    return bounds;
}

template <Axis axis>
std::size_t split_few(Site* sites, std::size_t count) {
    std::size_t rank[few] = {};
    for (std::size_t j = 1; j < count; ++j) {
        for (std::size_t i = 0; i < j; ++i) {
            const bool ahead = before(axis, sites[i].point, sites[j].point);
            rank[j] += ahead;
            rank[i] += !ahead;
        }
    }
    Site sorted[few];
    for (std::size_t i = 0; i < count; ++i) sorted[rank[i]] = sites[i];
    std::copy_n(sorted, count, sites);
    return count / 2;
}

Pair median(Pair p, Pair q, Pair r) {
    return greatest(least(p, q), least(greatest(p, q), r));
}

// Estimates from nine evenly spaced sites: Tukey's ninther of each coordinate, and the bounds.
struct Sample {
    Point near_middle;
    Bounds bounds;
};

Sample sample(const Site* sites, std::size_t count) {
    Pair nine[9];
    Bounds bounds(pair(sites[0].point));
    for (std::size_t k = 0; k < 9; ++k) bounds.add(nine[k] = pair(sites[k * (count / 9)].point));
    const auto of_three = [&](int k) { return median(nine[k], nine[k + 3], nine[k + 6]); };
    return {point(median(of_three(0), of_three(1), of_three(2))), bounds};
}

template <class GoesFirst>
std::size_t partition(Site* sites, std::size_t count, GoesFirst goes_first) {
    Site* middle = sites;
    for (Site* each = sites; each != sites + count; ++each) {
        const Site site = *each;
        *each = *middle;
        *middle = site;
        middle += goes_first(site.point);
    }
    return static_cast<std::size_t>(middle - sites);
}

// The points that share the pivot's coordinate stay together, as long as enough are left on either
// side.
template <Axis axis>
std::size_t split_many(Site* sites, std::size_t count, Point near_middle) {
    const double pivot = along(axis, near_middle);
    const auto is_balanced = [count](std::size_t middle) {
        return std::min(middle, count - middle) >= count / 8 + 1;
    };
    std::size_t middle =
        partition(sites, count, [pivot](Point p) { return along(axis, p) < pivot; });
    if (is_balanced(middle)) return middle;
    middle = partition(sites, count, [pivot](Point p) { return along(axis, p) <= pivot; });
    if (is_balanced(middle)) return middle;
    std::nth_element(sites, sites + count / 2, sites + count,
                     [](const Site& a, const Site& b) { return before(axis, a.point, b.point); });
    return count / 2;
}

}  // namespace

MedianSplit median_split(Site* sites, std::size_t count) {
    if (count <= few) {
        const Axis axis = bounds_of(sites, count).longer();
        return {axis, axis == Axis::x ? split_few<Axis::x>(sites, count)
                                      : split_few<Axis::y>(sites, count)};
    }
    const Sample some = sample(sites, count);
    const Axis axis = some.bounds.longer();
    return {axis, axis == Axis::x ? split_many<Axis::x>(sites, count, some.near_middle)
                                  : split_many<Axis::y>(sites, count, some.near_middle)};
}

}  // namespace liftmesh
