#include "sphere/sphere.hpp"

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "predicates/ray_side.hpp"
#include "predicates/space_lattice.hpp"
#include "sorting/patient_sort.hpp"
#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

using FacetName = std::uint32_t;
using EdgeName = std::uint32_t;  // 4 t + k for the edge of facet t opposite its vertex k

// The vertices, counter-clockwise, and the names of the same edges on their other sides.
struct SphereFacet {
    std::array<Vertex, 3> vertex;
    std::array<EdgeName, 3> across;

    Vertex tail(unsigned k) const { return vertex[(k + 1) % 3]; }
    Vertex head(unsigned k) const { return vertex[(k + 2) % 3]; }
};

class SphereInsertion {
 public:
    SphereInsertion(const SpaceOrder& points, Interrupt& interrupt, SphereResult& result)
        : points_(points), interrupt_(interrupt), patience_(interrupt), result_(result) {
        rays_.reserve(points.count);
        for (std::size_t i = 0; i < points.count; ++i) rays_.emplace_back(points.points[i]);
        facet_from_.resize(points.count);
    }

    // False if the interrupt came first.
    bool run(std::uint64_t secret) {
        constexpr int round_bits = 2;  // four times as many points in each round
        const std::vector<Vertex> order = biased_random_order(points_.count, round_bits, secret);
        std::size_t next = start(order);
        if (seed_.size() < 4) {
            result_.status = Status::too_few;
            result_.distinct = seed_.size();
            return true;
        }
        constexpr std::size_t reported_every = std::size_t{1} << 12;
        for (; next < order.size(); ++next) {
            if (next % reported_every == 0) interrupt_.advance(reported_every);
            insert(order[next]);
            if (patience_.ends(cavity_.size())) return false;
        }
        result_.distinct = points_.count - doubles_.size();
        return merge() && write();
    }

 private:
    static constexpr FacetName nowhere = ~FacetName{0};

    int side(Vertex a, Vertex b, Vertex c, Vertex d) const {
        return ray_side(rays_[a], rays_[b], rays_[c], rays_[d]);
    }

    bool note_if_double(Vertex v, std::span<const Vertex> others) {
        for (Vertex other : others) {
            if (!have_one_direction(rays_[v], rays_[other])) continue;
            doubles_.push_back({v, other});
            return true;
        }
        return false;
    }

    // Four points of different directions, of which the last is s. How many are used up.
    std::size_t start(const std::vector<Vertex>& order) {
        std::size_t next = 0;
        for (; next < order.size() && seed_.size() < 4; ++next)
            if (!note_if_double(order[next], seed_)) seed_.push_back(order[next]);
        if (seed_.size() < 4) return next;
        auto& s = seed_;
        if (side(s[0], s[1], s[2], s[3]) > 0) std::swap(s[0], s[1]);
        far_ = s[3];
        facets_ = {{{s[0], s[1], s[2]}, {}},
                   {{s[1], s[0], far_}, {}},
                   {{s[2], s[1], far_}, {}},
                   {{s[0], s[2], far_}, {}}};
        for (FacetName t = 0; t < 4; ++t) {
            for (unsigned k = 0; k < 3; ++k) {
                for (EdgeName e = 0; e < 16; ++e) {
                    if (e % 4 == 3) continue;
                    const SphereFacet& other = facets_[e / 4];
                    if (other.tail(e % 4) == facets_[t].head(k) &&
                        other.head(e % 4) == facets_[t].tail(k))
                        facets_[t].across[k] = e;
                }
            }
        }
        is_inside_.assign(4, false);
        last_ = 0;
        return next;
    }

    bool is_far(FacetName t) const {
        const auto& v = facets_[t].vertex;
        return v[0] == far_ || v[1] == far_ || v[2] == far_;
    }

    // To the facet that v is in, or a facet at s that it is above.
    FacetName locate(Vertex v) const {
        FacetName t = last_;
        if (is_far(t))
            for (unsigned k = 0; k < 3; ++k)
                if (facets_[last_].vertex[k] == far_) t = facets_[last_].across[k] / 4;
        for (EdgeName from = nowhere; !is_far(t);) {
            unsigned k = 0;
            while (k < 3 && (4 * t + k == from ||
                             side(facets_[t].tail(k), facets_[t].head(k), v, far_) <= 0))
                ++k;
            if (k == 3) break;
            from = facets_[t].across[k];
            t = from / 4;
        }
        return t;
    }

    void insert(Vertex v) {
        const FacetName first = locate(v);
        last_ = first;
        cavity_.clear();
        if (note_if_double(v, facets_[first].vertex) || note_if_double(v, {&far_, 1})) return;
        find_cavity(v, first);
        fill_cavity(v);
    }

    // What v is above is connected.
    void find_cavity(Vertex v, FacetName first) {
        cavity_.assign(1, first);
        rim_.clear();
        is_inside_[first] = true;
        for (std::size_t i = 0; i < cavity_.size(); ++i) {
            const SphereFacet at = facets_[cavity_[i]];
            for (unsigned k = 0; k < 3; ++k) {
                const FacetName t = at.across[k] / 4;
                if (is_inside_[t]) continue;
                const auto& [a, b, c] = facets_[t].vertex;
                if (side(a, b, c, v) > 0) {
                    is_inside_[t] = true;
                    cavity_.push_back(t);
                } else {
                    rim_.push_back({at.tail(k), at.head(k), at.across[k]});
                }
            }
        }
        for (FacetName t : cavity_) is_inside_[t] = false;
    }

    void fill_cavity(Vertex v) {
        std::size_t used = 0;
        for (RimEdge& edge : rim_) {
            if (used == cavity_.size()) {
                cavity_.push_back(static_cast<FacetName>(facets_.size()));
                facets_.emplace_back();
                is_inside_.push_back(false);
            }
            const FacetName t = cavity_[used++];
            facets_[t].vertex = {edge.tail, edge.head, v};
            join(4 * t + 2, edge.outside);
            facet_from_[edge.tail] = t;
        }
        for (const RimEdge& edge : rim_)
            join(4 * facet_from_[edge.tail], 4 * facet_from_[edge.head] + 1);
        last_ = cavity_.front();
    }

    void join(EdgeName e, EdgeName f) {
        facets_[e / 4].across[e % 4] = f;
        facets_[f / 4].across[f % 4] = e;
    }

    Row row(Vertex v) const { return points_.rows[v]; }

    // Of the rows of one direction the lowest is the vertex. Its place is the first on the curve of
    // all of them, whichever was inserted. False if the interrupt came first.
    bool merge() {
        row_.assign(points_.rows.get(), points_.rows.get() + points_.count);
        foremost_.resize(points_.count);
        std::iota(foremost_.begin(), foremost_.end(), Vertex{0});
        for (const auto& [v, vertex] : doubles_) {
            row_[vertex] = std::min(row_[vertex], row(v));
            foremost_[vertex] = std::min(foremost_[vertex], v);
        }
        for (const auto& [v, vertex] : doubles_) {
            result_.duplicates.push_back({row(v), row_[vertex]});
            if (row_[vertex] != row(vertex))
                result_.duplicates.push_back({row(vertex), row_[vertex]});
        }
        std::map<Row, Row> kept;
        for (const auto& [other, chosen] : result_.duplicates)
            if (other != chosen) kept[other] = chosen;
        for (Duplicate pair : points_.duplicates) {
            const auto found = kept.find(pair.kept);
            result_.duplicates.push_back(
                {pair.row, found == kept.end() ? pair.kept : found->second});
        }
        auto& all = result_.duplicates;
        const auto by_row = [](const Duplicate& a, const Duplicate& b) { return a.row < b.row; };
        std::erase_if(all, [](const Duplicate& pair) { return pair.row == pair.kept; });
        if (!patient_sort(all, by_row, interrupt_)) return false;
        all.erase(std::unique(all.begin(), all.end(),
                              [](const auto& a, const auto& b) { return a.row == b.row; }),
                  all.end());
        return true;
    }

    // False if the interrupt came first.
    bool write() {
        for (const auto& [v, vertex] : doubles_) row_[foremost_[vertex]] = row_[vertex];
        std::vector<std::pair<std::array<Vertex, 3>, FacetName>> sorted;
        std::vector<std::int32_t> place(facets_.size());
        std::vector<unsigned> least(facets_.size());
        for (FacetName t = 0; t < facets_.size(); ++t) {
            auto v = facets_[t].vertex;
            for (Vertex& each : v) each = foremost_[each];
            const auto at = std::min_element(v.begin(), v.end());
            least[t] = static_cast<unsigned>(at - v.begin());
            std::rotate(v.begin(), at, v.end());
            sorted.push_back({v, t});
        }
        if (!patient_sort(sorted, std::less<>(), interrupt_)) return false;
        for (std::size_t i = 0; i < sorted.size(); ++i)
            place[sorted[i].second] = static_cast<std::int32_t>(i);
        for (const auto& [v, t] : sorted) {
            std::array<std::int32_t, 3> rows, beside;
            for (unsigned k = 0; k < 3; ++k) {
                rows[k] = static_cast<std::int32_t>(row_[v[k]]);
                beside[k] = place[facets_[t].across[(k + least[t]) % 3] / 4];
            }
            result_.simplices.push_back(rows);
            result_.neighbors.push_back(beside);
        }
        return true;
    }

    struct RimEdge {
        Vertex tail, head;
        EdgeName outside;
    };

    const SpaceOrder& points_;
    Interrupt& interrupt_;
    Patience patience_;
    SphereResult& result_;
    std::vector<Ray> rays_;
    std::vector<SphereFacet> facets_;
    std::vector<std::uint8_t> is_inside_;
    std::vector<FacetName> cavity_, facet_from_;
    std::vector<RimEdge> rim_;
    std::vector<Vertex> seed_;
    std::vector<std::pair<Vertex, Vertex>> doubles_;  // each with the vertex of its direction
    std::vector<Row> row_;
    std::vector<Vertex> foremost_;
    Vertex far_ = 0;
    FacetName last_ = 0;
};

}  // namespace

SphereResult triangulate_sphere(const Input& input, bool skip_non_finite, std::uint64_t secret,
                                Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    SphereResult result;
    interrupt.expect(input.rows * (work::sorting + 1));
    result.status = Status::interrupted;
    SpaceRows rows;
    if (!read_space(input, interrupt, rows)) return result;
    if (!rows.skipped.empty() && !skip_non_finite) {
        result.status = Status::non_finite;
        result.row = rows.skipped.front();
        return result;
    }
    result.skipped = rows.skipped;
    ThreadPool alone({}, interrupt);
    SpaceOrder points;
    if (!sort_in_space(std::move(rows), alone, points)) return result;
    constexpr std::size_t most = 357'000'000;  // whose cells have fewer than 2^31 corners
    if (points.count > most) throw std::bad_alloc();
    result.status = Status::ok;
    if (!SphereInsertion(points, interrupt, result).run(secret))
        result.status = Status::interrupted;
    return result;
}

bool find_circle_centres(const SpacePoint* points, const std::int32_t* simplices, std::size_t count,
                         Interrupt& interrupt, SpacePoint* centres) {
    return for_each_in_blocks(count, interrupt, [&](std::size_t t) {
        UnitVector at[3];
        for (std::size_t k = 0; k < 3; ++k) at[k] = unit_vector(points[simplices[3 * t + k]]);
        const auto step = [&at](int k) {
            return Vector<DoubleWord<double>>{at[k].x - at[0].x, at[k].y - at[0].y,
                                              at[k].z - at[0].z};
        };
        const auto normal = cross(step(1), step(2));
        const double x = normal.x.high, y = normal.y.high, z = normal.z.high;
        const double length = std::sqrt(x * x + y * y + z * z);
        centres[t] = {x / length, y / length, z / length};
    });
}

bool find_sphere_cells(const std::int32_t* simplices, const std::int32_t* neighbors,
                       std::size_t count, std::size_t rows, Interrupt& interrupt,
                       SphereCells& cells) {
    constexpr std::size_t none = ~std::size_t{0};
    std::vector<std::size_t> first(rows, none);
    cells.starts.assign(rows + 1, 0);
    for (std::size_t place = 3 * count; place-- > 0;) {
        const auto at = static_cast<std::size_t>(simplices[place]);
        first[at] = place;
        ++cells.starts[at + 1];
    }
    std::partial_sum(cells.starts.begin(), cells.starts.end(), cells.starts.begin());
    cells.facets.reserve(3 * count);
    return for_each_in_blocks(rows, interrupt, [&](std::size_t v) {
        const auto row = static_cast<std::int32_t>(v);
        for (std::size_t place = first[v]; place != none;) {
            cells.facets.push_back(static_cast<std::int32_t>(place / 3));
            // Counter-clockwise around v lies what is across the edge that ends there.
            const std::size_t t = place / 3, k = place % 3;
            const auto next = static_cast<std::size_t>(neighbors[3 * t + (k + 1) % 3]);
            const std::int32_t* const corners = simplices + 3 * next;
            place =
                3 * next + static_cast<std::size_t>(std::find(corners, corners + 3, row) - corners);
            if (place == first[v]) break;
        }
    });
}

}  // namespace liftmesh
