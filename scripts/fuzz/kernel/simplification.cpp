// A terrain, with edges or without, and its approximations: no sample is further away than the
// tolerance, by integers of any length, on the canonical triangulation of what is left, which has
// all edges; and the order of rows does not matter.
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "checks.hpp"
#include "constrained/constrained.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "scatter.hpp"
#include "simplification/simplify.hpp"
#include "targets.hpp"

namespace fuzzing {

namespace {

using liftmesh::Status;
using liftmesh::simplification::Simplified;
using liftmesh::simplification::Terrain;
using Places = std::vector<std::array<double, 2>>;
using Edges = std::vector<std::int32_t>;  // two ends each

constexpr std::size_t most_samples = 70;
constexpr unsigned most_edges = 24;

liftmesh::Constrained constrained(const Scatter& at, const Edges& edges) {
    Impatient interrupt;
    return liftmesh::constrained_delaunay(at.input(), edges.data(), edges.size() / 2, false, {},
                                          interrupt);
}

// By the number that each row has now.
Edges renumbered(const Edges& edges, const std::vector<std::size_t>& rows) {
    Edges found;
    for (const std::int32_t end : edges) {
        const auto at = std::find(rows.begin(), rows.end(), static_cast<std::size_t>(end));
        demand(at != rows.end(), "the end of an edge is left out");
        found.push_back(static_cast<std::int32_t>(at - rows.begin()));
    }
    return found;
}

// What is asked for.
struct Wish {
    double tolerance;
    std::size_t most;
    bool prunes;
};

class Approximated {
 public:
    Approximated(const Scatter& at, Edges edges) : at_(at), edges_(std::move(edges)) {
        Impatient interrupt;
        whole_ = liftmesh::delaunay(at.input(), false, {}, interrupt);
    }
    bool has_area() const { return whole_.status == Status::ok; }
    Terrain plain() const {
        return {at_.points.data(), at_.heights.data(), at_.size(), whole_.result.hull.get(),
                whole_.result.hull_count};
    }
    Terrain terrain() const {
        Terrain found = plain();
        found.edges = edges_.data();
        found.edge_count = edges_.size() / 2;
        return found;
    }
    std::size_t fixed() const {
        return liftmesh::simplification::skeleton_of(terrain()).rows.size();
    }

    Simplified simplified(const Wish& wish, std::size_t patience = ~std::size_t{0}) const {
        Impatient interrupt(patience);
        return liftmesh::simplification::simplify(terrain(), wish.tolerance, wish.most, wish.prunes,
                                                  interrupt);
    }
    Simplified thinned(std::size_t most, std::size_t patience = ~std::size_t{0}) const {
        Impatient interrupt(patience);
        return liftmesh::simplification::thin(plain(), most, interrupt);
    }

    // Rows that are there once, the corners of the hull among them.
    void check_rows(const Simplified& found) const {
        const std::set<liftmesh::Row> rows(found.rows.begin(), found.rows.end());
        demand(rows.size() == found.rows.size(), "a row is kept twice");
        demand(rows.empty() || *rows.rbegin() < at_.size(), "a row is none");
        for (const liftmesh::Row corner : liftmesh::simplification::corners_of(plain()))
            demand(rows.contains(corner), "a corner of the hull is left out");
    }

    // Every sample, in the triangles of a fresh run on the rows that stay.
    void check_bound(const Simplified& found, double tolerance) const {
        const std::vector<std::size_t> rows(found.rows.begin(), found.rows.end());
        const Scatter kept = at_.in_order(rows);
        const auto fresh = constrained(kept, renumbered(edges_, rows));
        demand(fresh.status == Status::ok, "what is left has no triangles");
        demand(2 * fresh.pieces.size() == edges_.size(), "edges have other pieces");
        std::vector<bool> is_judged(at_.size());
        for (std::size_t t = 0; t < fresh.result.triangle_count; ++t) {
            SpacePoint corners[3];
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = kept.at(static_cast<std::size_t>(fresh.result.simplices[3 * t + k]));
            const Point planar[3] = {corners[0].planar(), corners[1].planar(), corners[2].planar()};
            for (std::size_t row = 0; row < at_.size(); ++row) {
                if (is_judged[row] || !contains(planar, at_.points[row])) continue;
                is_judged[row] = true;
                demand(!exceeds(corners[0], corners[1], corners[2], at_.at(row), tolerance),
                       "a sample is beyond the tolerance");
            }
        }
        demand(std::find(is_judged.begin(), is_judged.end(), false) == is_judged.end(),
               "a sample is outside");
    }

    Places places(const Simplified& found) const {
        Places kept;
        for (const liftmesh::Row row : found.rows)
            kept.push_back({at_.points[row].x, at_.points[row].y});
        std::sort(kept.begin(), kept.end());
        return kept;
    }

 private:
    const Scatter& at_;
    Edges edges_;
    liftmesh::Delaunay whole_;
};

Scatter drawn_scatter(unsigned what, Bytes& bytes) {
    if (what % 2 == 0) return raster_scatter(bytes);
    return what % 16 < 8 ? scatter(bytes, most_samples) : turned_scatter(bytes, most_samples);
}

Wish drawn_wish(const Scatter& at, Bytes& bytes) {
    const unsigned kind = bytes.byte();
    const double p = at.heights[bytes.byte() % at.size()], q = at.heights[bytes.byte() % at.size()];
    const double choice[] = {0, std::fabs(p / 2 - q / 2), bytes.byte() / 4.0, std::fabs(q)};
    const std::size_t most = kind / 16 % 3 == 0 ? 3 + bytes.byte() % 64 : 0;
    return {choice[kind % 4], most, kind % 8 < 4};
}

// Between rows that the bytes choose, unless one would cross an earlier one; in pieces.
Edges drawn_edges(const Scatter& at, Bytes& bytes) {
    Edges chosen, pieces;
    const auto row = [&] { return static_cast<std::int32_t>(bytes.byte() % at.size()); };
    for (unsigned left = bytes.byte() % 2 == 0 ? 0 : bytes.byte() % most_edges; left > 0; --left) {
        chosen.insert(chosen.end(), {row(), row()});
        if (!constrained(at, chosen).crossings.empty()) chosen.resize(chosen.size() - 2);
    }
    for (const auto [a, b] : constrained(at, chosen).pieces)
        pieces.insert(pieces.end(), {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)});
    return pieces;
}

void check_simplified(const Approximated& given, const Approximated& mixed, const Wish& wish) {
    const Simplified found = given.simplified(wish);
    demand(found.status == Status::ok, "a run ends early");
    given.check_rows(found);
    demand(found.is_within || wish.most != 0, "the tolerance is not reached");
    demand(found.rows.size() <= found.inserted, "more rows than were inserted");
    demand(wish.most == 0 || found.inserted <= std::max(wish.most, given.fixed()),
           "more vertices than asked for");
    if (found.is_within) given.check_bound(found, wish.tolerance);
    demand(given.places(found) == mixed.places(mixed.simplified(wish)),
           "the order of rows changes an approximation");
}

void check_thinned(const Approximated& given, const Approximated& mixed, std::size_t most) {
    const Simplified found = given.thinned(most);
    demand(found.status == Status::ok, "a run ends early");
    given.check_rows(found);
    demand(given.places(found) == mixed.places(mixed.thinned(most)),
           "the order of rows changes what is thinned");
}

void check_interrupted(const Approximated& given, const Wish& wish, std::size_t patience) {
    const Simplified cut = given.simplified(wish, patience), whole = given.simplified(wish);
    demand(cut.status == Status::interrupted || given.places(cut) == given.places(whole),
           "a run that could be interrupted comes to another result");
    const Simplified few = given.thinned(9, patience);
    demand(few.status == Status::interrupted || few.rows.size() >= 3, "too few rows are left");
}

}  // namespace

void check_simplification(Bytes bytes) {
    Bytes asked(bytes);  // the wish is drawn from the same bytes once more
    const unsigned what = bytes.byte();
    const Scatter at = drawn_scatter(what, bytes);
    if (at.size() < 3) return;
    const Wish wish = drawn_wish(at, asked);
    const Edges edges = drawn_edges(at, asked);
    const Approximated given(at, edges);
    if (!given.has_area()) return;
    Dice dice(what + at.size());
    const std::vector<std::size_t> order = shuffled(at.size(), dice);
    const Scatter in_other_order = at.in_order(order);
    const Approximated mixed(in_other_order, renumbered(edges, order));
    check_simplified(given, mixed, wish);
    check_thinned(given, mixed, 3 + dice.below(at.size()));
    check_interrupted(given, wish, 1 + dice.below(4));
}

}  // namespace fuzzing
