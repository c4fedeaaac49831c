// What the verifiers of tetrahedra and of triangles on the sphere share: vertices of rows, facets
// that simplices share (edges, of triangles), and the test of a closed surface in space.
#pragma once

#include "base/floating_point.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/patient_sort.hpp"
#include "sorting/space_order.hpp"
#include "verify/flaws.hpp"

namespace liftmesh {

// _MEANINGS in planar/space_verification.py has the same names in the same order. A facet is an
// edge where simplices are triangles on the sphere.
enum class SpaceFlaw : std::uint8_t {
    invalid_index,        // a corner that is not a row
    non_finite,           // a corner on a row that is not finite
    negative,             // a tetrahedron of negative volume
    degenerate,           // one of no volume; a triangle with two corners of one direction
    non_manifold_facets,  // a facet with several tetrahedra on one side: one of them, and which
    non_manifold_edges,   // two rows: an edge that does not join two facets of the surface
    boundary_winding,     // a row at which the surface turns around more than once
    not_convex,           // a facet of the surface, with a point outside of it or of the next
    missing_vertices,     // a row without a vertex at its position
    not_delaunay,         // a facet with the opposite vertex of a neighbour inside the sphere
    not_canonical,        // a facet that the symbolic perturbation would flip
    kinds
};

struct SpaceVerdict {
    Status status = Status::ok;
    std::size_t row = 0;  // the first non-finite row, where that is the status
    std::size_t skipped = 0, vertices = 0, merged = 0, facets = 0, hull_facets = 0;
    FlawsOf<SpaceFlaw> flaws;
};

// A facet of one simplex, by its ascending corners; of an edge, the last two are one.
struct FacetOfSimplex {
    Vertex middle, last;  // the least is known by the bucket
    std::uint32_t place;
    bool is_odd;  // whether the corners turn clockwise, seen from outside

    auto key() const { return std::tie(middle, last, is_odd, place); }
    bool is_same(const FacetOfSimplex& other) const {
        return middle == other.middle && last == other.last;
    }

    template <std::size_t N>
    static FacetOfSimplex of(std::array<Vertex, N> corners, std::size_t place) {
        bool is_odd = false;
        const auto order = [&](std::size_t i, std::size_t j) {
            if (corners[j] < corners[i]) std::swap(corners[i], corners[j]), is_odd = !is_odd;
        };
        order(0, 1);
        if constexpr (N == 3) order(1, 2), order(0, 1);
        return {corners[1], corners[N - 1], static_cast<std::uint32_t>(place), is_odd};
    }
};

// Reads the rows and sorts them for check(points, pool, verdict), which is false if the interrupt
// came first.
template <class Check>
SpaceVerdict verify_in_space(const Input& input, bool skip_non_finite, Threads threads,
                             Interrupt& interrupt, Check check) {
    const IeeeArithmetic ieee;
    constexpr std::size_t stages = 3;  // simplices, facets, rows
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
    if (!sort_in_space(std::move(rows), pool, points) || !check(points, pool, verdict))
        verdict.status = Status::interrupted;
    return verdict;
}

class SimplexVerifier {
 public:
    SimplexVerifier(const SpaceOrder& points, std::size_t rows, const std::int32_t* simplices,
                    std::size_t count, std::size_t corners, ThreadPool& pool, SpaceVerdict& verdict)
        : points_(points),
          rows_(rows),
          simplices_(simplices),
          count_(count),
          corners_(corners),
          pool_(pool),
          interrupt_(pool.interrupt()),
          verdict_(verdict) {}

 protected:
    using Flaws = FlawsOf<SpaceFlaw>;

    // What is found in a part of the simplices or facets, by any thread.
    struct Found {
        Flaws flaws;
        std::size_t facets = 0;
        std::vector<std::size_t> boundary;  // facets with one simplex alone
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

    const SpacePoint& at(Vertex v) const { return points_.points[v]; }
    Vertex corner(std::size_t place) const { return corner_[place]; }

    // Rows at one position are one vertex.
    bool name_vertices() {
        vertex_of_.assign(rows_, no_vertex);
        for (Vertex v = 0; v < points_.count; ++v) vertex_of_[points_.rows[v]] = v;
        for (const Duplicate& pair : points_.duplicates)
            vertex_of_[pair.row] = vertex_of_[pair.kept];
        return !interrupt_.requested();
    }

    bool check_corners() {
        std::vector<std::uint8_t> is_corner(rows_);
        if (!corner_) corner_ = allocate<Vertex>(corners_ * count_);
        const auto note = [&](std::size_t place) {
            const auto row = static_cast<std::size_t>(simplices_[place]);
            if (simplices_[place] < 0 || row >= rows_)
                add(SpaceFlaw::invalid_index, place);
            else if (vertex_of_[row] == no_vertex)
                add(SpaceFlaw::non_finite, place);
            else
                is_corner[row] = true, corner_[place] = vertex_of_[row];
        };
        const bool done = for_each_in_blocks(corners_ * count_, interrupt_, note);
        is_vertex_.assign(points_.count, false);
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

    bool find_missing() {
        return for_each(points_.count, [this](std::size_t v, Found& found) {
            const Row row = points_.rows[v];
            if (vertex_of_[row] == v && !is_vertex_[v])
                found.flaws.add(SpaceFlaw::missing_vertices, {row, 0});
        });
    }

    // Calls visit(least, same, found) for all facets with the same corners: by their least corner,
    // then by the others.
    template <class FacetAt, class Visit>
    bool pair_facets(std::size_t places, FacetAt facet_at, Visit visit) {
        CountingSort by_least(places, few_shares(places / block, pool_.size()), points_.count,
                              pool_);
        const auto all = allocate<FacetOfSimplex>(places);
        const bool done = by_least.sort(
            [](const Share& share, auto each) {
                for (std::size_t place = share.first; place < share.last; ++place) each(place);
            },
            [&](std::size_t place) {
                const auto corners = facet_at(place);
                return *std::min_element(corners.begin(), corners.end());
            },
            [&](std::size_t to, std::size_t place) {
                all[to] = FacetOfSimplex::of(facet_at(place), place);
            });
        if (!done) return false;
        const std::vector<std::size_t> starts = std::move(by_least).starts();
        return for_each(points_.count, [&](std::size_t v, Found& found) {
            const std::span own(&all[starts[v]], starts[v + 1] - starts[v]);
            visit_same(own, [&](std::span<const FacetOfSimplex> same) {
                visit(static_cast<Vertex>(v), same, found);
            });
        });
    }

    // A closed surface of `count` triangles. Calls visit(place, other, found) for the places of
    // edges that two of them share, once for each.
    template <class Triangle, class Visit>
    bool pair_edges(std::size_t count, Triangle triangle, Visit visit) {
        const auto edge_at = [&](std::size_t place) {
            const std::array<Vertex, 3> at = triangle(place / 3);
            return std::array{at[(place + 1) % 3], at[(place + 2) % 3]};
        };
        return pair_facets(3 * count, edge_at, [&](Vertex least, auto same, Found& found) {
            const auto &first = same.front(), &last = same.back();
            if (same.size() == 2 && first.is_odd != last.is_odd)
                visit(first.place, last.place, found);
            else
                found.flaws.add(SpaceFlaw::non_manifold_edges,
                                {points_.rows[least], points_.rows[first.last]});
        });
    }

    // The triangles at u are a fan seen from the first edge, in which no edge is outside of the
    // first triangle: so they turn around once. rises(a, b, c, d) tells whether d is outside of the
    // triangle of the others.
    template <class Triangle, class Rises>
    bool check_turn(std::size_t count, Triangle triangle, Vertex u, Rises rises) {
        std::vector<std::pair<Vertex, Vertex>> fan;
        const bool done = for_each_in_blocks(count, interrupt_, [&](std::size_t i) {
            const std::array<Vertex, 3> at = triangle(i);
            for (std::size_t k = 0; k < 3; ++k)
                if (at[k] == u) fan.push_back({at[(k + 1) % 3], at[(k + 2) % 3]});
        });
        if (!done || !patient_sort(fan, std::less<>(), interrupt_)) return false;
        const auto [start, second] = fan.front();
        std::size_t spokes = 0;
        for (Vertex v = start; spokes == 0 || v != start; ++spokes) {
            const Vertex next =
                std::lower_bound(fan.begin(), fan.end(), std::pair(v, Vertex{0}))->second;
            if (rises(u, start, second, v) || rises(u, start, v, next))
                add(SpaceFlaw::boundary_winding, points_.rows[u]);
            v = next;
        }
        if (spokes != fan.size()) add(SpaceFlaw::boundary_winding, points_.rows[u]);
        return true;
    }

    static constexpr Vertex no_vertex = ~Vertex{0};

    const SpaceOrder& points_;
    std::size_t rows_;
    const std::int32_t* simplices_;
    std::size_t count_, corners_;
    ThreadPool& pool_;
    Interrupt& interrupt_;
    SpaceVerdict& verdict_;
    std::vector<Vertex> vertex_of_;  // of each row
    Buffer<Vertex> corner_;          // of each place
    std::vector<std::uint8_t> is_vertex_;
    std::vector<std::size_t> boundary_;

 private:
    template <class Visit>
    void visit_same(std::span<FacetOfSimplex> facets, Visit visit) {
        const auto is_before = [](const FacetOfSimplex& a, const FacetOfSimplex& b) {
            return a.key() < b.key();
        };
        if (!patient_sort(facets, is_before, interrupt_)) return;
        for (std::size_t i = 0, end; i < facets.size(); i = end) {
            for (end = i + 1; end < facets.size() && facets[end].is_same(facets[i]);) ++end;
            visit(facets.subspan(i, end - i));
        }
    }

    std::mutex mutex_;
};

}  // namespace liftmesh
