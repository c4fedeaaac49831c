// Flaws of a triangulation: the count and the first places of each kind; and the triangles that are
// verified, as all steps of the verifier see them (`MeshView`).
#pragma once

#include "base/point.hpp"
#include "parallel/blocks.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh {

// MEANINGS in planar/violations.py has the same names in the same order.
enum class Flaw : std::uint8_t {
    invalid_index,          // a corner that is not a row
    non_finite,             // a corner on a row that is not finite
    clockwise,              // a triangle that turns clockwise
    degenerate,             // a triangle whose corners are collinear
    non_manifold_edges,     // a half-edge with another triangle on the same side
    non_manifold_vertices,  // a row that the boundary visits more than once
    boundary_loops,         // a closed curve of the boundary, where there are several
    boundary_winding,       // the boundary winds around more than once
    not_convex,             // a row at which the boundary turns right or back
    missing_vertices,       // a row without a vertex at its position
    missing_constraints,    // a constraint, and the row at which no edge continues it
    open_boundaries,        // an edge of a carved boundary off all constraints and the hull
    overlaps,               // two edges of a carved boundary
    not_delaunay,           // an edge whose opposite apex lies inside the circumcircle
    not_canonical,          // an edge that the symbolic perturbation would flip
    kinds
};

// Where a flaw is. The meaning of the two numbers depends on the flaw: a row, a triangle, a place
// among the corners (edge k of triangle t is opposite corner 3 t + k), or two of these.
struct FlawPlace {
    std::uint64_t at, other;
    auto operator<=>(const FlawPlace&) const = default;
};

// A count of places, and the smallest few of them.
class FlawPlaces {
 public:
    static constexpr std::size_t kept = 16;

    void add(FlawPlace place) {
        ++count_;
        keep(place);
    }
    void add(const FlawPlaces& other) {
        count_ += other.count_;
        for (const FlawPlace& place : other.first_) keep(place);
    }
    std::size_t count() const { return count_; }
    const std::vector<FlawPlace>& first() const { return first_; }

 private:
    void keep(FlawPlace place) {
        if (first_.size() == kept && first_.back() <= place) return;
        first_.insert(std::upper_bound(first_.begin(), first_.end(), place), place);
        if (first_.size() > kept) first_.pop_back();
    }

    std::size_t count_ = 0;
    std::vector<FlawPlace> first_;  // ascending
};

template <class Kind>
class FlawsOf {
 public:
    void add(Kind flaw, FlawPlace place) { places_[static_cast<std::size_t>(flaw)].add(place); }
    void add(const FlawsOf& other) {
        for (std::size_t i = 0; i < places_.size(); ++i) places_[i].add(other.places_[i]);
    }
    const FlawPlaces& operator[](Kind flaw) const {
        return places_[static_cast<std::size_t>(flaw)];
    }

    bool any(Kind flaw) const { return (*this)[flaw].count() > 0; }
    bool any() const {
        return std::any_of(places_.begin(), places_.end(),
                           [](const FlawPlaces& places) { return places.count() > 0; });
    }

 private:
    std::array<FlawPlaces, static_cast<std::size_t>(Kind::kinds)> places_;
};

using Flaws = FlawsOf<Flaw>;

class Sides;

// An edge of one triangle, directed so that the triangle lies on its left. `place` is the place of
// the opposite corner.
struct HalfEdge {
    Row tail, head;
    std::uint32_t place;
};

// The triangulation to verify: positions, and triangles over them.
struct MeshView {
    const Point* points;
    std::size_t rows;
    const std::int32_t* simplices;  // count x 3
    std::size_t count;
    Guard guard;                           // of the points
    const Sides* sides = nullptr;          // of other lifts than |p|^2
    const double* values = nullptr;        // of each row, where the lift has them
    const std::uint32_t* order = nullptr;  // the caller's number of each triangle, if reordered
    std::int32_t* neighbors = nullptr;     // count x 3, filled in by `pair_edges` if they are there
    bool reversed = false;                 // the last two corners of each triangle are swapped
    bool finite = false;                   // every row is

    Row corner(std::size_t place) const { return static_cast<Row>(simplices[place]); }
    Point point(std::size_t place) const { return points[corner(place)]; }

    // The place of the corner in the caller's array.
    std::size_t callers_place(std::size_t place) const {
        const std::size_t triangle = order == nullptr ? place / 3 : order[place / 3];
        const std::size_t corner = reversed ? (3 - place % 3) % 3 : place % 3;
        return 3 * triangle + corner;
    }

    HalfEdge half_edge(std::size_t triangle, int k) const {
        const std::size_t first = 3 * triangle;
        constexpr int next[] = {1, 2, 0, 1};
        return {corner(first + next[k]), corner(first + next[k + 1]),
                static_cast<std::uint32_t>(first + k)};
    }
};

// The number of triangles, or rows, of one task. It does not depend on the number of threads, so
// no result does.
inline constexpr std::size_t block = std::size_t{1} << 15;

inline std::size_t blocks(std::size_t count) {
    return blocks(count, block);
}

}  // namespace liftmesh
