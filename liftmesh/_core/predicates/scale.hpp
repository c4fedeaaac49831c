// The power of two that scales coordinates into the window of the in-circle filter.
//
// Multiplying by a power of two changes no sign, and within the window it loses no bit: a set of
// denormals is triangulated as fast as any other. Only sets that span more than 339 binary orders
// of magnitude are left unscaled, and their in-circle tests take the guarded path.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh {

// The least and the greatest magnitude among non-zero coordinates.
class Range {
 public:
    void add(Point p) { add(pair(p)); }
    void add(Pair p) {
        const Pair size = magnitudes(p);
        least_ = liftmesh::least(size == Pair{} ? Pair{infinity, infinity} : size, least_);
        greatest_ = liftmesh::greatest(greatest_, size);
    }
    void add(const Range& other) {
        least_ = liftmesh::least(least_, other.least_);
        greatest_ = liftmesh::greatest(greatest_, other.greatest_);
    }
    bool empty() const { return greatest() == 0; }
    double least() const { return std::min(least_[0], least_[1]); }
    double greatest() const { return std::max(greatest_[0], greatest_[1]); }

 private:
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    Pair least_ = {infinity, infinity}, greatest_ = {};
};

struct Scale {
    bool moves = false;
    double first = 1, second = 1;  // two factors: 2^1273 overflows
    Guard guard = Guard::in_window();

    // The least exponent may be that of another filter's window.
    explicit Scale(const Range& range, int least_allowed = Guard::least_exponent) {
        if (range.empty()) return;
        const int least = std::ilogb(range.least());
        const int greatest = std::ilogb(range.greatest());
        if (least >= least_allowed && greatest < Guard::greatest_exponent) return;
        if (greatest - least >= Guard::greatest_exponent - 1 - least_allowed) {
            guard = Guard::anywhere();
            return;
        }
        moves = true;
        const int shift = Guard::greatest_exponent - 1 - greatest;
        first = std::ldexp(1.0, shift / 2);
        second = std::ldexp(1.0, shift - shift / 2);
    }

    // Undoes what this does.
    Scale inverse() const {
        Scale back = *this;
        back.first = 1 / first;
        back.second = 1 / second;
        return back;
    }

    Point operator()(Point p) const { return {p.x * first * second, p.y * first * second}; }
};

}  // namespace liftmesh
