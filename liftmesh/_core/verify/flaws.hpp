// What is wrong with a triangulation: how often, and where first.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace liftmesh {

enum class Flaw : std::uint8_t {
    index,       // a corner that is no row
    non_finite,  // a corner on a row that is not finite
    clockwise,
    flat,
    doubled,    // a side along which another triangle lies on the same side
    pinched,    // a row through which the border goes more than once
    pieces,     // a closed curve of the border, where there are several
    winding,    // the border goes round more than once
    hull,       // a row at which the border turns inward
    missing,    // a row without a vertex at its position
    delaunay,   // a side whose other apex lies inside the circle
    canonical,  // a side that the rule for ties would have exchanged
    kinds
};

// Where a flaw is. What the two numbers mean is the flaw's to say: a row, a triangle, a place among
// the corners (side k of triangle t faces corner 3 t + k), or two of these.
struct Place {
    std::uint64_t at, other;
    auto operator<=>(const Place&) const = default;
};

// The number of places, and the least few of them.
class Places {
 public:
    static constexpr std::size_t kept = 16;

    void add(Place place) {
        ++count_;
        keep(place);
    }
    void add(const Places& other) {
        count_ += other.count_;
        for (const Place& place : other.first_) keep(place);
    }
    std::size_t count() const { return count_; }
    const std::vector<Place>& first() const { return first_; }

 private:
    void keep(Place place) {
        if (first_.size() == kept && first_.back() <= place) return;
        first_.insert(std::upper_bound(first_.begin(), first_.end(), place), place);
        if (first_.size() > kept) first_.pop_back();
    }

    std::size_t count_ = 0;
    std::vector<Place> first_;  // ascending
};

class Flaws {
 public:
    void add(Flaw flaw, Place place) { places_[static_cast<std::size_t>(flaw)].add(place); }
    void add(const Flaws& other) {
        for (std::size_t i = 0; i < places_.size(); ++i) places_[i].add(other.places_[i]);
    }
    const Places& operator[](Flaw flaw) const { return places_[static_cast<std::size_t>(flaw)]; }

    bool any(Flaw flaw) const { return (*this)[flaw].count() > 0; }
    bool any() const {
        return std::any_of(places_.begin(), places_.end(),
                           [](const Places& places) { return places.count() > 0; });
    }

 private:
    std::array<Places, static_cast<std::size_t>(Flaw::kinds)> places_;
};

}  // namespace liftmesh
