// Sites seen along a base edge, for merges of every lift: first those of lifts without values, then
// sites of a value, then both in one form.
#pragma once

#include "base/pair.hpp"
#include "predicates/incircle.hpp"
#include "predicates/lift.hpp"
#include "predicates/lifted_side.hpp"

namespace liftmesh {

// A lifted point seen along a lifted base edge a -> b.
//
// Shear the paraboloid, which moves no facet, until both ends of the base lie at height 0: the lift
// of p is then at the height (p - a)(p - b), and its distance from the base, counted in lengths of
// the base and positive on the left, is (b - a) x (p - a). A plane through the base rises by height
// over distance. So the lift of d is below the plane through the base and the lift of c where
//     height(c) distance(d) - height(d) distance(c) > 0    for c on the left,
// which is the in-circle determinant of a, b, c, d: one multiplication for each pair, once the
// places of both points are known.
//
// Rounding, with e = 2^-53: the distance and the height are off by at most (1 + e)^4 - 1 of the
// sums of magnitudes of which they are made, the determinant by at most (1 + e)^10 - 1 of its own.
// `Certainty` bounds the error for all points of a box, so that a sign costs one comparison.
// `error_of_below` is made for the points of one call: `bound` gives the sums as computed, at least
// (1 - e)^4 of the true ones, and 10 e + 155 e^2 of what is computed suffices. Where `Guard`
// vouches for the coordinates a distance or a height is 0 or at least 2^-436, and nothing
// underflows.

// In a box of width w and height h the sums of magnitudes are at most 2 w h for a distance,
// w^2 + h^2 for a height, and 4 w h (w^2 + h^2) for a determinant: the errors stay below 8 e w h
// and 40 e w h (w^2 + h^2), each by less than one part in 10^14. The constants exceed that by more
// than the rounding of w, h and the bounds themselves.
struct Certainty {
    double of_distance, of_circle;

    static Certainty within(Pair low, Pair high, Guard guard) {
        constexpr double e = 0x1p-53;
        const Pair size = high - low;
        const double area = size[0] * size[1];
        return {8.5 * e * area + guard.margin(),
                41 * e * area * (size[0] * size[0] + size[1] * size[1]) + guard.margin()};
    }
};

inline Certainty certainty_within(Paraboloid, Pair low, Pair high, Guard guard) {
    return Certainty::within(low, high, guard);
}
inline Certainty certainty_within(Farthest, Pair low, Pair high, Guard guard) {
    return Certainty::within(low, high, guard);
}

// A height by a metric takes two roundings more, a determinant 12.
inline Certainty certainty_within(const ByMetric& by, Pair low, Pair high, Guard guard) {
    constexpr double e = 0x1p-53;
    const Pair size = high - low;
    const Pair height = by.magnitude_of_product(size, size);
    return {Certainty::within(low, high, guard).of_distance,
            49 * e * size[0] * size[1] * (height[0] + height[1]) + guard.margin()};
}

template <class Lift>
class Base {
 public:
    Base() = default;
    Base(const Lift& lift, Pair a, Pair b)
        : lift_(lift), a_(a), b_(b), across_{a[1] - b[1], b[0] - a[0]} {}

    Pair from_a(Pair p) const { return p - a_; }

    // Distance and height.
    Pair place(Pair p) const {
        const Pair from_a = p - a_;
        const Pair distance = across_ * from_a;
        const Pair height = lift_.product(from_a, p - b_);
        return Pair{distance[0], height[0]} + Pair{distance[1], height[1]};
    }
    // The sums of magnitudes of which a place is made.
    Pair bound(Pair p) const {
        const Pair from_a = p - a_;
        const Pair distance = magnitudes(across_ * from_a);
        const Pair height = lift_.magnitude_of_product(from_a, p - b_);
        return Pair{distance[0], height[0]} + Pair{distance[1], height[1]};
    }

 private:
    [[no_unique_address]] Lift lift_;
    Pair a_, b_, across_;
};

// Positive where the lift of d is below the plane through the base and the lift of c, given the
// places of both.
inline double below(Pair c, Pair d) {
    const Pair product = c * swapped(d);
    return product[1] - product[0];
}

// No more than that it is off, given the bounds of both.
template <class Lift>
double error_of_below(Pair c, Pair d) {
    const Pair product = c * swapped(d);
    return Lift::determinant_error * (product[0] + product[1]);
}

// A lowered point seen along a lifted base edge a -> b: the same for sites of a value.
//
// With B, C, D the vectors from a to b, c and d, and with C x D for their cross product, shear the
// space so that the lifts of a and b, but for the excess of b over a, are at height 0. The point c
// is then at the height h(c) = (c - a)(c - b) - excess(c, a), plus excess(b, a) at any linear
// function that is 0 at a and 1 at b. By the identity of Jacobi the latter needs no function:
//
//     h(c) (B x D) - h(d) (B x C) + excess(b, a) (C x D)
//
// is positive where the lift of d is below the plane through the base and the lift of c.
//
// Rounding, with e = 2^-53: an excess is off by (1 + e)^3 - 1 of itself, a height by at most
// (1 + e)^5 - 1 of its magnitudes, the determinant by at most (1 + e)^12 - 1 of its own. In a box
// of width w and height h with values that differ by an excess of at most x these are
// 4 w h (w^2 + h^2) + 6 w h x. `error_of_below` is made for the points of one call. Where `Guard`
// vouches, radii are in the window of the coordinates and weights are 0 or in [2^-280, 2^400]: an
// excess is 0 or at least 2^-332, no product is below 2^-872, and nothing underflows.

template <class Lift>
Certainty certainty_within(Pair low, Pair high, typename Lift::Value least,
                           typename Lift::Value greatest, Guard guard) {
    constexpr double e = 0x1p-53;
    const Certainty plain = Certainty::within(low, high, guard);
    const Pair size = high - low;
    const double area = size[0] * size[1];
    const double squares = size[0] * size[0] + size[1] * size[1];
    const double excess = Lift::excess(greatest, least);
    return {plain.of_distance, e * area * (49 * squares + 74 * excess) + guard.margin()};
}

template <class Lift>
class LiftedBase {
 public:
    using Value = typename Lift::Value;

    struct Place {
        Pair distance_and_height;
        Pair from_a;

        double distance() const { return distance_and_height[0]; }
    };

    LiftedBase() = default;
    LiftedBase(Pair a, Value at_a, Pair b, Value at_b)
        : base_({}, a, b), at_a_(at_a), excess_(Lift::excess(at_b, at_a)) {}

    Place place(Pair p, Value at_p) const {
        return {base_.place(p) - Pair{0, Lift::excess(at_p, at_a_)}, base_.from_a(p)};
    }

    double below(const Place& c, const Place& d) const {
        const Pair turn = c.from_a * swapped(d.from_a);
        return liftmesh::below(c.distance_and_height, d.distance_and_height) +
               excess_ * (turn[0] - turn[1]);
    }

    // No more than that it is off.
    double error_of_below(Pair c, Value at_c, Pair d, Value at_d) const {
        constexpr double bound = 14 * 0x1p-53;
        const Pair product = magnitude(c, at_c) * swapped(magnitude(d, at_d));
        const Pair turn = magnitudes(base_.from_a(c) * swapped(base_.from_a(d)));
        return bound * ((product[0] + product[1]) + std::fabs(excess_) * (turn[0] + turn[1]));
    }

 private:
    // The sums of magnitudes of which a distance and a height are made.
    Pair magnitude(Pair p, Value at_p) const {
        return base_.bound(p) + Pair{0, std::fabs(Lift::excess(at_p, at_a_))};
    }

    Base<Paraboloid> base_;
    Value at_a_;
    double excess_;
};

// Sites without values are in convex position when lifted, or known to be.
template <class Lift>
inline constexpr bool hides_sites = !std::is_empty_v<typename Lift::Value>;

template <class Lift>
struct Located {
    Pair at;
    [[no_unique_address]] typename Lift::Value value;

    operator Lifted<Lift>() const { return {point(at), value}; }
};

template <class Lift>
class SeenFromBase {
    template <class Other>
    struct OfSite {
        using Base = liftmesh::Base<Other>;
        using Place = Pair;
    };
    template <class Other>
        requires hides_sites<Other>
    struct OfSite<Other> {
        using Base = LiftedBase<Other>;
        using Place = typename Base::Place;
    };

 public:
    using Site = Located<Lift>;
    using Place = typename OfSite<Lift>::Place;

    SeenFromBase(const Lift& lift, const Site& a, const Site& b) : base_(made(lift, a, b)) {}

    Place place(const Site& p) const {
        if constexpr (hides_sites<Lift>) {
            return base_.place(p.at, p.value);
        } else {
            return base_.place(p.at);
        }
    }

    static double distance(const Place& place) {
        if constexpr (hides_sites<Lift>) {
            return place.distance();
        } else {
            return place[0];
        }
    }

    // Positive where the lift of d is below the plane through the base and the lift of c.
    double below(const Place& c, const Place& d) const {
        if constexpr (hides_sites<Lift>) {
            return base_.below(c, d);
        } else {
            return liftmesh::below(c, d);
        }
    }

    double error_of_below(const Site& c, const Site& d) const {
        if constexpr (hides_sites<Lift>) {
            return base_.error_of_below(c.at, c.value, d.at, d.value);
        } else {
            return liftmesh::error_of_below<Lift>(base_.bound(c.at), base_.bound(d.at));
        }
    }

 private:
    static auto made(const Lift& lift, const Site& a, const Site& b) {
        if constexpr (hides_sites<Lift>) {
            return LiftedBase<Lift>(a.at, a.value, b.at, b.value);
        } else {
            return Base<Lift>(lift, a.at, b.at);
        }
    }

    typename OfSite<Lift>::Base base_;
};

}  // namespace liftmesh
