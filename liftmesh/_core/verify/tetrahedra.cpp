#include "verify/tetrahedra.hpp"

#include "base/floating_point.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/patient_sort.hpp"
#include "sorting/space_order.hpp"

namespace liftmesh {

namespace {

constexpr Vertex no_vertex = ~Vertex{0};

// A facet seen from one tetrahedron, by its ascending corners.
struct SpaceFacet {
    Vertex middle, last;  // the least is known by the bucket
    std::uint32_t place;
    bool is_odd;  // whether the corners turn clockwise, seen from outside

    auto key() const { return std::tie(middle, last, is_odd, place); }
    bool is_same(const SpaceFacet& other) const {
        return middle == other.middle && last == other.last;
    }
};

class TetrahedraVerifier {
 public:
    TetrahedraVerifier(const SpaceOrder& points, const std::int32_t* simplices, std::size_t count,
                       ThreadPool& pool, SpaceVerdict& verdict)
        : points_(points),
          simplices_(simplices),
          count_(count),
          pool_(pool),
          interrupt_(pool.interrupt()),
          verdict_(verdict) {}

    // False if the interrupt came first.
    bool run(std::size_t rows) {
        if (!name_vertices(rows) || !check_corners()) return false;
        if (verdict_.flaws.any()) return true;
        if (!check_volumes() || !pair_facets()) return false;
        verdict_.hull_facets = boundary_.size();
        return check_boundary() && find_missing();
    }

 private:
    using Flaws = FlawsOf<SpaceFlaw>;

    // What is found in a part of the tetrahedra or facets, by any thread.
    struct Found {
        Flaws flaws;
        std::size_t facets = 0;
        std::vector<std::size_t> boundary;  // facets with one tetrahedron alone
    };

    // Calls check(i, found) for all; what is found is put together whatever thread was first.
    template <class Check>
    bool for_each(std::size_t count, Check check) {
        return in_blocks(count, block, pool_, [&](std::size_t i, std::size_t last, std::size_t) {
            interrupt_.advance((last - i) * rows_ / count);
            Found found;
            for (; i < last; ++i) check(i, found);
            const std::lock_guard lock(mutex_);
            verdict_.flaws.add(found.flaws);
            verdict_.facets += found.facets;
            boundary_.insert(boundary_.end(), found.boundary.begin(), found.boundary.end());
        });
    }

    void add(SpaceFlaw flaw, std::uint64_t at, std::uint64_t other = 0) {
        verdict_.flaws.add(flaw, {at, other});
    }

    // Rows at one position are one vertex.
    bool name_vertices(std::size_t rows) {
        vertex_of_ = allocate<Vertex>(rows);
        std::fill_n(vertex_of_.get(), rows, no_vertex);
        rows_ = rows;
        for (Vertex v = 0; v < points_.count; ++v) vertex_of_[points_.rows[v]] = v;
        for (const Duplicate& pair : points_.duplicates)
            vertex_of_[pair.row] = vertex_of_[pair.kept];
        return !interrupt_.requested();
    }

    bool check_corners() {
        std::vector<std::uint8_t> is_corner(rows_);
        const bool done = for_each_in_blocks(4 * count_, interrupt_, [&](std::size_t place) {
            const auto row = static_cast<std::size_t>(simplices_[place]);
            if (simplices_[place] < 0 || row >= rows_)
                add(SpaceFlaw::invalid_index, place);
            else if (vertex_of_[row] == no_vertex)
                add(SpaceFlaw::non_finite, place);
            else
                is_corner[row] = true;
        });
        is_vertex_.resize(points_.count);
        std::size_t corners = 0;
        for (std::size_t row = 0; row < rows_; ++row) {
            if (!is_corner[row]) continue;
            ++corners;
            is_vertex_[vertex_of_[row]] = true;
        }
        verdict_.vertices =
            static_cast<std::size_t>(std::count(is_vertex_.begin(), is_vertex_.end(), true));
        verdict_.merged = corners - verdict_.vertices;
        return done;
    }

    Vertex corner(std::size_t place) const {
        return vertex_of_[static_cast<std::size_t>(simplices_[place])];
    }
    const SpacePoint& at(Vertex v) const { return points_.points[v]; }
    int side(Vertex a, Vertex b, Vertex c, Vertex d) const {
        return volume_sign(at(a), at(b), at(c), at(d), points_.trust);
    }

    bool check_volumes() {
        return for_each(count_, [this](std::size_t t, Found& found) {
            const std::size_t first = 4 * t;
            const int sign =
                side(corner(first), corner(first + 1), corner(first + 2), corner(first + 3));
            if (sign <= 0)
                found.flaws.add(sign < 0 ? SpaceFlaw::negative : SpaceFlaw::degenerate, {t, 0});
        });
    }

    std::array<Vertex, 3> facet(std::size_t place) const {
        const auto& k = outward[place % 4];
        const std::size_t first = place - place % 4;
        return {corner(first + k[0]), corner(first + k[1]), corner(first + k[2])};
    }

    // By their least corner, then by the others.
    bool pair_facets() {
        CountingSort by_least(4 * count_, few_shares(count_ / block, pool_.size()), points_.count,
                              pool_);
        const auto all = allocate<SpaceFacet>(4 * count_);
        const bool done = by_least.sort(
            [](const Share& share, auto visit) {
                for (std::size_t place = share.first; place < share.last; ++place) visit(place);
            },
            [this](std::size_t place) {
                const auto [a, b, c] = facet(place);
                return std::min({a, b, c});
            },
            [&](std::size_t to, std::size_t place) { all[to] = sorted(place); });
        if (!done) return false;
        const std::vector<std::size_t> starts = std::move(by_least).starts();
        const bool is_solid =
            !verdict_.flaws.any(SpaceFlaw::negative) && !verdict_.flaws.any(SpaceFlaw::degenerate);
        return for_each(points_.count,
                        [&](std::size_t v, Found& found) {
                            pair(std::span(&all[starts[v]], starts[v + 1] - starts[v]), is_solid,
                                 found);
                        }) &&
               patient_sort(boundary_, std::less<>(), interrupt_);
    }

    SpaceFacet sorted(std::size_t place) const {
        auto [a, b, c] = facet(place);
        bool is_odd = false;
        const auto order = [&](Vertex& u, Vertex& v) {
            if (v < u) std::swap(u, v), is_odd = !is_odd;
        };
        order(a, b), order(b, c), order(a, b);
        return {b, c, static_cast<std::uint32_t>(place), is_odd};
    }

    void pair(std::span<SpaceFacet> facets, bool is_solid, Found& found) {
        const auto is_before = [](const SpaceFacet& a, const SpaceFacet& b) {
            return a.key() < b.key();
        };
        if (!patient_sort(facets, is_before, interrupt_)) return;
        for (std::size_t i = 0, end; i < facets.size(); i = end) {
            for (end = i + 1; end < facets.size() && facets[end].is_same(facets[i]);) ++end;
            pair_same(facets.subspan(i, end - i), is_solid, found);
        }
    }

    void pair_same(std::span<const SpaceFacet> same, bool is_solid, Found& found) const {
        ++found.facets;
        for (std::size_t i = 1; i < same.size(); ++i)
            if (same[i].is_odd == same[i - 1].is_odd)
                found.flaws.add(SpaceFlaw::non_manifold_facets, {same[i].place, same[i - 1].place});
        if (same.size() == 1)
            found.boundary.push_back(same.front().place);
        else if (is_solid && same.front().is_odd != same.back().is_odd)
            check_sphere(same.front().place, same.back().place, found.flaws);
    }

    void check_sphere(std::size_t place, std::size_t other, Flaws& flaws) const {
        const std::size_t first = place - place % 4;
        const SpacePoint five[5] = {at(corner(first)), at(corner(first + 1)), at(corner(first + 2)),
                                    at(corner(first + 3)), at(corner(other))};
        const auto& [a, b, c, d, e] = five;
        if (!is_inside_sphere(a, b, c, d, e, points_.trust)) return;
        const bool is_tie = insphere_exact(five, points_.trust) == 0;
        flaws.add(is_tie ? SpaceFlaw::not_canonical : SpaceFlaw::not_delaunay,
                  {std::min(place, other), std::max(place, other)});
    }

    struct BoundaryEdge {
        Vertex tail, head;
        std::size_t facet;  // number on the boundary
        auto operator<=>(const BoundaryEdge&) const = default;
    };

    bool check_boundary() {
        if (boundary_.empty()) return true;
        std::vector<BoundaryEdge> edges;
        const bool done = for_each_in_blocks(boundary_.size(), interrupt_, [&](std::size_t i) {
            const auto [a, b, c] = facet(boundary_[i]);
            edges.insert(edges.end(), {{a, b, i}, {b, c, i}, {c, a, i}});
            for (std::size_t k = 0; k < 4; ++k)
                if (side(a, b, c, corner(k)) > 0) add(SpaceFlaw::not_convex, boundary_[i]);
        });
        if (!done || !patient_sort(edges, std::less<>(), interrupt_) ||
            !for_each_in_blocks(edges.size(), interrupt_,
                                [&](std::size_t i) { check_edge(edges, i); }))
            return false;
        if (!verdict_.flaws.any(SpaceFlaw::non_manifold_edges)) check_turn(edges);
        return true;
    }

    static auto from(const std::vector<BoundaryEdge>& edges, Vertex tail, Vertex head) {
        return std::lower_bound(edges.begin(), edges.end(), BoundaryEdge{tail, head, 0});
    }

    // The facet on the other side must not rise above that on this side.
    void check_edge(const std::vector<BoundaryEdge>& edges, std::size_t i) {
        const auto [tail, head, number] = edges[i];
        const bool is_repeated = i > 0 && edges[i - 1].tail == tail && edges[i - 1].head == head;
        const auto back = from(edges, head, tail);
        if (is_repeated || back == edges.end() || back->tail != head || back->head != tail) {
            add(SpaceFlaw::non_manifold_edges, points_.rows[tail], points_.rows[head]);
            return;
        }
        const auto [a, b, c] = facet(boundary_[number]);
        for (Vertex v : facet(boundary_[back->facet]))
            if (side(a, b, c, v) > 0) add(SpaceFlaw::not_convex, boundary_[number]);
    }

    // The facets at the largest vertex are a fan seen from the first edge, in which no edge is
    // outside of the first facet: so they turn around once.
    void check_turn(const std::vector<BoundaryEdge>& edges) {
        const auto u = largest_of_boundary();
        const auto first = from(edges, u, 0);
        const Vertex start = first->head;
        const Vertex second = third_corner(*first);
        std::size_t spokes = 0;
        for (Vertex v = start; spokes == 0 || v != start; ++spokes) {
            const Vertex next = third_corner(*from(edges, u, v));
            if (side(u, start, second, v) > 0 || side(u, start, v, next) > 0)
                add(SpaceFlaw::boundary_winding, points_.rows[u]);
            v = next;
        }
        const auto last = from(edges, u + 1, 0);
        if (spokes != static_cast<std::size_t>(last - first))
            add(SpaceFlaw::boundary_winding, points_.rows[u]);
    }

    Vertex largest_of_boundary() const {
        Vertex largest = facet(boundary_.front())[0];
        for (std::size_t place : boundary_)
            for (Vertex v : facet(place))
                if (before_xyz(at(largest), at(v))) largest = v;
        return largest;
    }

    Vertex third_corner(const BoundaryEdge& edge) const {
        for (Vertex v : facet(boundary_[edge.facet]))
            if (v != edge.tail && v != edge.head) return v;
        return edge.head;  // GCOV_EXCL_LINE: of a facet with equal corners, which is flat
    }

    bool find_missing() {
        return for_each(points_.count, [this](std::size_t v, Found& found) {
            if (!is_vertex_[v]) found.flaws.add(SpaceFlaw::missing_vertices, {points_.rows[v], 0});
        });
    }

    const SpaceOrder& points_;
    const std::int32_t* simplices_;
    std::size_t count_, rows_ = 0;
    ThreadPool& pool_;
    Interrupt& interrupt_;
    SpaceVerdict& verdict_;
    std::mutex mutex_;
    Buffer<Vertex> vertex_of_;  // of each row
    std::vector<std::uint8_t> is_vertex_;
    std::vector<std::size_t> boundary_;
};

}  // namespace

SpaceVerdict verify_tetrahedra(const Input& input, const std::int32_t* simplices, std::size_t count,
                               bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    constexpr std::size_t stages = 3;  // volumes, facets, rows
    interrupt.expect(input.rows * (work::sorting + stages));
    SpaceVerdict verdict;
    SpaceRows rows;
    if (!read_space(input, interrupt, rows)) {
        verdict.status = Status::interrupted;
        return verdict;
    }
    verdict.skipped = rows.skipped.size();
    if (!rows.skipped.empty() && !skip_non_finite) {
        verdict.status = Status::non_finite;
        verdict.row = rows.skipped.front();
        return verdict;
    }
    ThreadPool pool(threads.for_rows(rows.count), interrupt);
    SpaceOrder points;
    if (!sort_in_space(std::move(rows), pool, points) ||
        !TetrahedraVerifier(points, simplices, count, pool, verdict).run(input.rows))
        verdict.status = Status::interrupted;
    return verdict;
}

}  // namespace liftmesh
