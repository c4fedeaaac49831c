// What is wrong with a triangulation: the count and the first places of each kind of flaw.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace liftmesh {

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

}  // namespace liftmesh
