#include "alpha/alpha.hpp"

#include "base/components.hpp"
#include "parallel/blocks.hpp"
#include "predicates/insphere.hpp"
#include "sorting/patient_sort.hpp"
#include "tetrahedra/edge_rings.hpp"

namespace liftmesh {

namespace {

// As `outward`, of a triangle.
constexpr unsigned along[3][2] = {{1, 2}, {2, 0}, {0, 1}};

template <int K>
constexpr const unsigned* corners_of_facet(std::size_t k) {
    if constexpr (K == 4)
        return outward[k];
    else
        return along[k];
}

template <int K>
std::array<std::int32_t, K - 1> facet_of(const SimplexView<K>& view, std::size_t place) {
    const unsigned* const corner = corners_of_facet<K>(place % K);
    const std::int32_t* const simplex = view.simplices + (place - place % K);
    std::array<std::int32_t, K - 1> facet;
    for (unsigned i = 0; i < K - 1; ++i) facet[i] = simplex[corner[i]];
    return facet;
}

template <std::size_t K>
Corners<static_cast<int>(K)> positions(const SpacePoint* points,
                                       const std::array<std::int32_t, K>& rows) {
    Corners<static_cast<int>(K)> corners;
    for (std::size_t i = 0; i < K; ++i) corners[i] = points[rows[i]];
    return corners;
}

// Rounds radii two at a time.
template <int K>
class RadiusBatch {
 public:
    explicit RadiusBatch(RadiusRounding rounding) : rounding_(rounding) {}
    ~RadiusBatch() { finish(); }

    void add(const Corners<K>& corners, double& radius) {
        corners_[waiting_] = corners;
        radius_[waiting_++] = &radius;
        if (waiting_ < 2) return;
        const auto [first, second] = circumradii<K>(corners_, rounding_);
        *radius_[0] = first;
        *radius_[1] = second;
        waiting_ = 0;
    }

 private:
    void finish() {
        if (waiting_ > 0) *radius_[0] = circumradius<K>(corners_[0], rounding_);
    }

    RadiusRounding rounding_;
    unsigned waiting_ = 0;
    std::array<Corners<K>, 2> corners_;
    double* radius_[2];
};

// A facet belongs to the first of its two simplices, or to the only one.
template <int K>
bool is_first(const SimplexView<K>& view, std::size_t place) {
    const std::int32_t other = view.neighbors[place];
    return other < 0 || static_cast<std::size_t>(other) > place / K;
}

// The place of the same facet beyond.
template <int K>
std::size_t across(const SimplexView<K>& view, std::size_t place) {
    const auto other = static_cast<std::size_t>(view.neighbors[place]);
    const auto here = static_cast<std::int32_t>(place / K);
    const std::int32_t* const back = view.neighbors + K * other;
    return K * other + static_cast<std::size_t>(std::find(back, back + K, here) - back);
}

// Whether no vertex of the simplices at a facet lies strictly inside its smallest sphere.
template <int K>
bool is_gabriel(const SimplexView<K>& view, std::size_t place, const Corners<K - 1>& corners) {
    const auto holds = [&](std::size_t at) {
        return is_inside_smallest_sphere(corners, view.points[view.simplices[at]]);
    };
    return !holds(place) && (view.neighbors[place] < 0 || !holds(across<K>(view, place)));
}

template <int K>
bool round_radii(const SpacePoint* points, const std::int32_t* simplices, std::size_t count,
                 RadiusRounding rounding, Interrupt& interrupt, double* radii) {
    RadiusBatch<K> batch(rounding);
    return for_each_in_blocks(count, interrupt, [&](std::size_t i) {
        std::array<std::int32_t, K> rows;
        std::copy_n(simplices + K * i, K, rows.begin());
        batch.add(positions(points, rows), radii[i]);
    });
}

}  // namespace

template <int K>
bool circumradii(const SpacePoint* points, const std::int32_t* simplices, std::size_t count,
                 RadiusRounding rounding, Interrupt& interrupt, double* radii) {
    return round_radii<K>(points, simplices, count, rounding, interrupt, radii);
}

namespace {

// Lists the facets, and writes the number of each at both of its places.
template <int K>
bool number_facets(const SimplexView<K>& view, Interrupt& interrupt, std::uint32_t* numbers,
                   AlphaFaces<K - 1>& facets) {
    return for_each_in_blocks(K * view.count, interrupt, [&](std::size_t place) {
        if (!is_first<K>(view, place)) return;
        numbers[place] = static_cast<std::uint32_t>(facets.corners.size());
        if (view.neighbors[place] >= 0) numbers[across<K>(view, place)] = numbers[place];
        auto rows = facet_of<K>(view, place);
        std::sort(rows.begin(), rows.end());
        facets.corners.push_back(rows);
    });
}

template <int K>
bool find_radii(const SimplexView<K>& view, const double* radii, Interrupt& interrupt,
                AlphaFaces<K - 1>& facets) {
    RadiusBatch<K - 1> batch(RadiusRounding::up);
    facets.radii.resize(facets.corners.size());
    auto rows = facets.corners.begin();
    auto radius = facets.radii.begin();
    return for_each_in_blocks(K * view.count, interrupt, [&](std::size_t place) {
        if (!is_first<K>(view, place)) return;
        const auto corners = positions(view.points, *rows++);
        const std::int32_t other = view.neighbors[place];
        const double here = radii[place / K];
        if (is_gabriel<K>(view, place, corners))
            batch.add(corners, *radius++);
        else
            *radius++ = other < 0 ? here : std::min(here, radii[other]);
    });
}

}  // namespace

namespace {

bool find_edges(const SimplexView<4>& view, const std::uint32_t* facet_at, Interrupt& interrupt,
                AlphaFiltration<4>& found) {
    constexpr double own = -1;  // that of the edge itself, which is rounded in the end
    EdgeRings edges(view.simplices, view.neighbors, view.count);
    std::vector<std::int32_t> vertices;
    std::vector<std::uint32_t> facets;
    const auto add_facet = [&](const AtEdge& at, unsigned k, unsigned beside) {
        facets.push_back(facet_at[4 * static_cast<std::size_t>(at.t) + k]);
        vertices.push_back(edges.corner(at.t, beside));
    };
    const auto radius_of = [&](std::array<std::int32_t, 2> rows) {
        const Corners<2> ends = positions(view.points, rows);
        const auto holds = [&](std::int32_t v) {
            return is_inside_smallest_sphere(ends, view.points[v]);
        };
        if (std::none_of(vertices.begin(), vertices.end(), holds)) return own;
        double radius = std::numeric_limits<double>::infinity();
        for (std::uint32_t facet : facets) radius = std::min(radius, found.facets.radii[facet]);
        return radius;
    };
    const auto add = [&](const std::vector<AtEdge>& ring, bool is_open) {
        vertices.clear(), facets.clear();
        if (const AtEdge& at = ring.front(); is_open) add_facet(at, at.last(), at.first());
        for (const AtEdge& at : ring) add_facet(at, at.first(), at.last());
        const AtEdge& at = ring.front();
        found.edges.corners.push_back({edges.corner(at.t, at.tail), edges.corner(at.t, at.head)});
        found.edges.radii.push_back(radius_of(found.edges.corners.back()));
    };
    const bool done =
        for_each_in_blocks(view.count, interrupt, [&](std::size_t t) { edges.visit(t, add); });
    RadiusBatch<2> batch(RadiusRounding::up);
    return done && for_each_in_blocks(found.edges.radii.size(), interrupt, [&](std::size_t i) {
               double& radius = found.edges.radii[i];
               if (radius == own) batch.add(positions(view.points, found.edges.corners[i]), radius);
           });
}

}  // namespace

template <>
bool find_alpha_filtration(const SimplexView<3>& view, const double* radii, Interrupt& interrupt,
                           AlphaFiltration<3>& found) {
    const auto numbers = allocate<std::uint32_t>(3 * view.count);
    return number_facets<3>(view, interrupt, numbers.get(), found.facets) &&
           find_radii<3>(view, radii, interrupt, found.facets);
}

template <>
bool find_alpha_filtration(const SimplexView<4>& view, const double* radii, Interrupt& interrupt,
                           AlphaFiltration<4>& found) {
    const auto numbers = allocate<std::uint32_t>(4 * view.count);
    return number_facets<4>(view, interrupt, numbers.get(), found.facets) &&
           find_radii<4>(view, radii, interrupt, found.facets) &&
           find_edges(view, numbers.get(), interrupt, found);
}

template <int K>
bool find_alpha_surface(const SimplexView<K>& view, double alpha, Interrupt& interrupt,
                        std::uint8_t* is_inside, AlphaSurface<K>& surface) {
    const bool done = for_each_in_blocks(view.count, interrupt, [&](std::size_t t) {
        std::array<std::int32_t, K> rows;
        std::copy_n(view.simplices + K * t, K, rows.begin());
        is_inside[t] = is_radius_at_most<K>(positions(view.points, rows), alpha);
    });
    if (!done) return false;
    return for_each_in_blocks(K * view.count, interrupt, [&](std::size_t place) {
        const std::int32_t other = view.neighbors[place];
        const bool is_beyond = other >= 0 && is_inside[other];
        if (is_inside[place / K]) {
            if (!is_beyond) surface.facets.push_back(facet_of<K>(view, place));
        } else if (!is_beyond && is_first<K>(view, place)) {
            auto rows = facet_of<K>(view, place);
            const auto corners = positions(view.points, rows);
            if (!is_radius_at_most<K - 1>(corners, alpha) || !is_gabriel<K>(view, place, corners))
                return;
            std::sort(rows.begin(), rows.end());
            surface.singular.push_back(rows);
        }
    });
}

namespace {

// The radius from which on every vertex has a simplex.
double covering_alpha(const std::int32_t* simplices, std::size_t count, std::size_t corners,
                      std::size_t rows, const double* radii) {
    std::vector<double> least(rows, -1);
    for (std::size_t place = 0; place < count * corners; ++place) {
        double& found = least[static_cast<std::size_t>(simplices[place])];
        const double radius = radii[place / corners];
        if (found < 0 || radius < found) found = radius;
    }
    return *std::max_element(least.begin(), least.end());
}

}  // namespace

double solid_alpha(const std::int32_t* simplices, const std::int32_t* neighbors, std::size_t count,
                   std::size_t corners, std::size_t rows, const double* radii,
                   std::size_t components, Interrupt& interrupt) {
    const double covering = covering_alpha(simplices, count, corners, rows, radii);
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    // All up to there are added in any order.
    const auto rest = std::partition(order.begin(), order.end(),
                                     [&](std::uint32_t t) { return radii[t] <= covering; });
    const auto is_before = [radii](std::uint32_t a, std::uint32_t b) {
        return std::tie(radii[a], a) < std::tie(radii[b], b);
    };
    if (!patient_sort(std::span(rest, order.end()), is_before, interrupt))
        return std::numeric_limits<double>::quiet_NaN();
    Components solid(count);
    Patience patience(interrupt);
    for (auto at = order.begin(); at != order.end(); ++at) {
        const std::size_t t = *at;
        solid.add(t);
        for (std::size_t k = 0; k < corners; ++k) {
            const std::int32_t other = neighbors[corners * t + k];
            if (other >= 0 && solid.has(static_cast<std::size_t>(other)))
                solid.join(t, static_cast<std::size_t>(other));
        }
        if (patience.ends()) return std::numeric_limits<double>::quiet_NaN();
        const double alpha = std::max(radii[t], covering);
        const bool is_whole = at + 1 == order.end() || radii[at[1]] > alpha;
        if (is_whole && solid.count() <= components) return alpha;
    }
    return std::numeric_limits<double>::infinity();  // GCOV_EXCL_LINE: all are one component
}

template bool circumradii<3>(const SpacePoint*, const std::int32_t*, std::size_t, RadiusRounding,
                             Interrupt&, double*);
template bool circumradii<4>(const SpacePoint*, const std::int32_t*, std::size_t, RadiusRounding,
                             Interrupt&, double*);
template bool find_alpha_surface<3>(const SimplexView<3>&, double, Interrupt&, std::uint8_t*,
                                    AlphaSurface<3>&);
template bool find_alpha_surface<4>(const SimplexView<4>&, double, Interrupt&, std::uint8_t*,
                                    AlphaSurface<4>&);

}  // namespace liftmesh
