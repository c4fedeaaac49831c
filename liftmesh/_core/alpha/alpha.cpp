#include "alpha/alpha.hpp"

#include "parallel/blocks.hpp"

namespace liftmesh {

namespace {

// The corners of facet k, counter-clockwise seen from outside: of a tetrahedron, then a triangle.
constexpr unsigned outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
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

}  // namespace

template <int K>
bool circumradii(const SpacePoint* points, const std::int32_t* simplices, std::size_t count,
                 RadiusRounding rounding, Interrupt& interrupt, double* radii) {
    RadiusBatch<K> batch(rounding);
    return for_each_in_blocks(count, interrupt, [&](std::size_t i) {
        std::array<std::int32_t, K> rows;
        std::copy_n(simplices + K * i, K, rows.begin());
        batch.add(positions(points, rows), radii[i]);
    });
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

// What is around an edge of tetrahedra.
class EdgeRing {
 public:
    EdgeRing(const SimplexView<4>& view, const std::uint32_t* facet_at)
        : view_(view), facet_at_(facet_at) {}

    // From tetrahedron t, whose corners i and j are the edge. False if an earlier one has it too,
    // which is looked for on both sides in turn: so rings take O(n log n) steps in all, whatever
    // the order of the tetrahedra. A closed ring has the facet at which it closes twice.
    bool find(std::size_t t, unsigned i, unsigned j) {
        const std::int32_t* const v = view_.simplices + 4 * t;
        unsigned k = 0;
        while (k == i || k == j) ++k;
        const unsigned l = 6 - i - j - k;
        vertices.clear();
        facets.clear();
        ends_ = {v[i], v[j]};
        std::size_t exits[] = {4 * t + k, 4 * t + l};
        bool is_open[] = {true, true};
        for (std::size_t exit : exits) note(exit);
        for (unsigned side = 0; is_open[0] || is_open[1]; side = 1 - side) {
            if (!is_open[side]) continue;
            const std::int32_t next = view_.neighbors[exits[side]];
            is_open[side] = next >= 0;
            if (!is_open[side]) continue;
            if (static_cast<std::size_t>(next) < t) return false;
            exits[side] = exit_of(static_cast<std::size_t>(next), exits[side] / 4);
            note(exits[side]);
            if (facets.back() == facet_at_[exits[1 - side]]) return true;
        }
        return true;
    }

    std::vector<std::int32_t> vertices;
    std::vector<std::uint32_t> facets;

 private:
    void note(std::size_t place) {
        facets.push_back(facet_at_[place]);
        vertices.push_back(third(place));
    }

    // The corner of a facet beside the edge.
    std::int32_t third(std::size_t place) const {
        const std::int32_t* const v = view_.simplices + (place - place % 4);
        std::size_t k = 0;
        while (k == place % 4 || v[k] == ends_[0] || v[k] == ends_[1]) ++k;
        return v[k];
    }

    // In a tetrahedron at the edge that was entered from another one, the other facet at the edge.
    std::size_t exit_of(std::size_t t, std::size_t from) const {
        const std::int32_t* const v = view_.simplices + 4 * t;
        const auto back = static_cast<std::int32_t>(from);
        std::size_t k = 0;
        while (v[k] == ends_[0] || v[k] == ends_[1] || view_.neighbors[4 * t + k] == back) ++k;
        return 4 * t + k;
    }

    const SimplexView<4>& view_;
    const std::uint32_t* facet_at_;
    std::array<std::int32_t, 2> ends_{};
};

bool find_edges(const SimplexView<4>& view, const std::uint32_t* facet_at, Interrupt& interrupt,
                AlphaFiltration<4>& found) {
    constexpr double own = -1;  // that of the edge itself, which is rounded in the end
    EdgeRing ring(view, facet_at);
    const auto radius_of = [&](std::array<std::int32_t, 2> rows) {
        const Corners<2> ends = positions(view.points, rows);
        const auto holds = [&](std::int32_t v) {
            return is_inside_smallest_sphere(ends, view.points[v]);
        };
        if (std::none_of(ring.vertices.begin(), ring.vertices.end(), holds)) return own;
        double radius = std::numeric_limits<double>::infinity();
        for (std::uint32_t facet : ring.facets)
            radius = std::min(radius, found.facets.radii[facet]);
        return radius;
    };
    const bool done = for_each_in_blocks(view.count, interrupt, [&](std::size_t t) {
        for (unsigned j = 1; j < 4; ++j) {
            for (unsigned i = 0; i < j; ++i) {
                if (!ring.find(t, i, j)) continue;
                const auto [a, b] =
                    std::minmax(view.simplices[4 * t + i], view.simplices[4 * t + j]);
                found.edges.corners.push_back({a, b});
                found.edges.radii.push_back(radius_of({a, b}));
            }
        }
    });
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

// Union-find with path halving (R. E. Tarjan and J. van Leeuwen, 1984).
class Components {
 public:
    explicit Components(std::size_t count) : parent_(count, none) {}

    std::size_t count() const { return count_; }
    bool has(std::size_t i) const { return parent_[i] != none; }
    void add(std::size_t i) {
        parent_[i] = static_cast<std::uint32_t>(i);
        ++count_;
    }
    void join(std::size_t i, std::size_t j) {
        const std::uint32_t a = root(i), b = root(j);
        if (a == b) return;
        parent_[std::max(a, b)] = std::min(a, b);
        --count_;
    }

 private:
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    std::uint32_t root(std::size_t i) {
        auto at = static_cast<std::uint32_t>(i);
        while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
        return at;
    }

    std::vector<std::uint32_t> parent_;
    std::size_t count_ = 0;
};

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
    std::sort(rest, order.end(), [radii](std::uint32_t a, std::uint32_t b) {
        return std::tie(radii[a], a) < std::tie(radii[b], b);
    });
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
