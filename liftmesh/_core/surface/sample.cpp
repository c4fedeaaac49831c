#include "surface/sample.hpp"

#include "base/buffer.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t queries_at_once = std::size_t{1} << 22;  // bounds the memory of the triangles

// Calls judge(query, triangle, patience) for each.
template <class Judge>
bool at_each(Locator& locator, const Queries& queries, Threads threads, Interrupt& interrupt,
             Judge judge) {
    const auto found = allocate<std::int32_t>(std::min(queries.count, queries_at_once));
    for (std::size_t start = 0; start < queries.count; start += queries_at_once) {
        const Queries some{queries.coordinates + 2 * start,
                           std::min(queries_at_once, queries.count - start)};
        const auto settled = [&, start](std::size_t i, std::int32_t triangle, Patience& patience) {
            judge(start + i, triangle, patience);
        };
        if (!locator.find(some, found.get(), threads, interrupt, settled)) return false;
    }
    return true;
}

// As `blend` does of three.
double blend(const Relief& relief, const NaturalNeighbors& neighbors,
             const std::vector<double>& weights) {
    const double first = relief.height_of(neighbors.row(0));
    double low = first, high = first, sum = 0, half = 0;
    for (std::size_t i = 1; i < weights.size(); ++i) {
        const double z = relief.height_of(neighbors.row(i));
        sum += weights[i] * (z - first);
        half += weights[i] * (z / 2 - first / 2);
        low = std::min(low, z);
        high = std::max(high, z);
    }
    const double z = first + sum;
    if (std::isfinite(z)) return std::clamp(z, low, high);
    return std::clamp(first / 2 + half, low / 2, high / 2) * 2;
}

// At vertices, on sides of the hull and outside as the linear height, which is the limit there.
double natural_height(const Relief& relief, Point query, std::int32_t triangle, Natural method,
                      Patience& patience) {
    thread_local NaturalNeighbors::Room room;
    const Place place = relief.place(query, triangle);
    const bool is_within =
        place.kind == Place::inside ||
        (place.kind == Place::side && relief.mesh().neighbor(triangle, place.k) >= 0);
    const auto linear = [&] { return relief.height(query, triangle, place, patience); };
    if (!is_within) return linear();
    if (!relief.is_shown(triangle, place)) return no_height;
    NaturalNeighbors neighbors(relief.mesh(), room);
    const bool is_sound = neighbors.find(query, triangle, patience);
    if (patience.ends(0)) return no_height;
    if (!is_sound) return linear();
    const std::vector<double>& weights = neighbors.weigh(method);
    return weights.empty() ? linear() : blend(relief, neighbors, weights);
}

double nearest_height(const Relief& relief, Point query, std::int32_t triangle,
                      Patience& patience) {
    const Place place = relief.place(query, triangle);
    if (place.kind == Place::vertex) return relief.height(query, triangle, place, patience);
    if (place.kind == Place::beyond || !relief.is_shown(triangle, place)) return no_height;
    const std::int32_t row = relief.nearest(query, triangle, patience);
    return row < 0 ? no_height : relief.height_of(row);
}

// Also where there is no face.
double nearest_beyond(const Relief& relief, Point query, std::int32_t triangle,
                      Patience& patience) {
    if (!std::isfinite(query.x) || !std::isfinite(query.y)) return no_height;
    const std::int32_t row = relief.nearest(query, triangle, patience);
    return row < 0 ? no_height : relief.height_of(row);
}

}  // namespace

bool sample_heights(const Relief& relief, Locator& locator, const Queries& queries, double* heights,
                    Threads threads, Interrupt& interrupt) {
    return at_each(locator, queries, threads, interrupt,
                   [&](std::size_t i, std::int32_t triangle, Patience& patience) {
                       heights[i] =
                           triangle < 0 ? no_height : relief.height(queries[i], triangle, patience);
                   });
}

bool sample_natural(const Relief& relief, Locator& locator, const Queries& queries, Natural method,
                    double* heights, Threads threads, Interrupt& interrupt) {
    const auto height = [&, method](Point query, std::int32_t triangle, Patience& patience) {
        if (method == Natural::nearest_beyond)
            return nearest_beyond(relief, query, triangle, patience);
        if (triangle < 0) return no_height;
        return method == Natural::nearest
                   ? nearest_height(relief, query, triangle, patience)
                   : natural_height(relief, query, triangle, method, patience);
    };
    return at_each(locator, queries, threads, interrupt,
                   [&](std::size_t i, std::int32_t triangle, Patience& patience) {
                       heights[i] = height(queries[i], triangle, patience);
                   });
}

bool sample_gradients(const Relief& relief, Locator& locator, const Queries& queries,
                      double* gradients, Threads threads, Interrupt& interrupt) {
    return at_each(locator, queries, threads, interrupt,
                   [&](std::size_t i, std::int32_t triangle, Patience& patience) {
                       const std::int32_t owner =
                           triangle < 0 ? outside : relief.owner(queries[i], triangle, patience);
                       const Point slopes =
                           owner < 0 ? Point{no_height, no_height} : relief.facet(owner).gradient();
                       gradients[2 * i] = slopes.x;
                       gradients[2 * i + 1] = slopes.y;
                   });
}

bool sample_owners(const Relief& relief, Locator& locator, const Queries& queries,
                   std::int32_t* owners, Threads threads, Interrupt& interrupt) {
    return at_each(locator, queries, threads, interrupt,
                   [&](std::size_t i, std::int32_t triangle, Patience& patience) {
                       owners[i] =
                           triangle < 0 ? outside : relief.owner(queries[i], triangle, patience);
                   });
}

}  // namespace liftmesh
