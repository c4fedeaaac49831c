// The height policies: to what height each kind of triangulation lifts a point. A lower facet of
// the lifted points is a triangle of their Delaunay triangulation, or of a relative of it.
//
// The predicates, the merges and the engine are templates over a lift, so that each member of the
// family is an instance of the same code. A site is a position with a value: its weight, its
// radius, or nothing. The value lowers the site:
//
//     Paraboloid     z = |p|^2                          Delaunay
//     ByWeight       z = |p|^2 - w                      regular triangulation (power diagram)
//     ByRadius       z = |p|^2 - r^2                    the same, where r^2 is never rounded
//     ByMetric       z = a x^2 + 2 b x y + c y^2        Delaunay in a constant metric
//     Farthest       z = -|p|^2                         farthest-point Delaunay
//
// `excess` is by how much one site is lowered more than another: for filters, with few roundings
// and therefore with a small relative error, however large the values are.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "predicates/scale.hpp"

namespace liftmesh {

template <class Lift>
struct Lifted {
    Point point;
    [[no_unique_address]] typename Lift::Value value;
};

// For lifts without values, `product` is the inner product of two vectors, as two summands: that of
// p - a and p - b is the height of p above the chord of a and b, sheared to height 0.
struct Paraboloid {
    struct Value {
        bool operator==(const Value&) const = default;
    };
    // Relative errors of in-circle determinants: seen_from_base.hpp.
    static constexpr double determinant_error = (10 + 160 * 0x1p-53) * 0x1p-53;

    static Pair product(Pair u, Pair v) { return u * v; }
    static Pair magnitude_of_product(Pair u, Pair v) { return magnitudes(u * v); }
};

// The lower hull of these heights is the upper hull of the paraboloid, mirrored. Its vertices are
// the corners of the convex hull of the points.
struct Farthest {
    using Value = Paraboloid::Value;
    static constexpr double determinant_error = Paraboloid::determinant_error;

    static Pair product(Pair u, Pair v) { return -(u * v); }
    static Pair magnitude_of_product(Pair u, Pair v) { return magnitudes(u * v); }
};

struct ByWeight {
    using Value = double;
    static double excess(Value p, Value q) { return p - q; }
    static bool is_heavier(Value p, Value q) { return p > q; }
};

struct ByRadius {
    using Value = double;  // not negative
    static double excess(Value p, Value q) { return (p - q) * (p + q); }
    static bool is_heavier(Value p, Value q) { return p > q; }
};

// The quadratic form of a symmetric matrix [[a, b], [b, c]], positive definite.
struct ByMetric {
    using Value = Paraboloid::Value;
    static constexpr double determinant_error = 14 * 0x1p-53;

    double a, b, c;

    Pair product(Pair u, Pair v) const { return u * (Pair{a, c} * v + Pair{b, b} * swapped(v)); }
    Pair magnitude_of_product(Pair u, Pair v) const {
        const Pair w = magnitudes(v);
        return magnitudes(u) * (magnitudes(Pair{a, c}) * w + magnitudes(Pair{b, b}) * swapped(w));
    }
};

// How values and metrics follow the scale of the coordinates: no side changes.

// The range of values as one of coordinates, so that their scale has room for both. A weight counts
// as its square root: then the window of coordinates holds its square.
inline Range as_coordinates(const ByRadius&, const Range& values) {
    return values;
}
inline Range as_coordinates(const ByWeight&, const Range& values) {
    if (values.empty()) return values;
    const auto root = [](double w) { return std::ldexp(1.0, std::ilogb(w) >> 1); };
    Range roots;
    roots.add(Pair{root(values.least()), root(values.greatest())});
    return roots;
}

inline double scaled(const ByRadius&, double value, const Scale& scale) {
    return value * scale.first * scale.second;
}
inline double scaled(const ByWeight&, double value, const Scale& scale) {
    return value * scale.first * scale.second * scale.first * scale.second;
}

// The largest coefficient in [1, 2), unless another becomes too small for the filters: then none
// of them is trusted, and the metric stays as it is.
inline Guard fit(ByMetric& by, Guard guard) {
    const int shift = -std::ilogb(std::max({by.a, std::fabs(by.b), by.c}));
    for (double value : {by.a, by.b, by.c})
        if (value != 0 && std::ilogb(value) + shift < -100) return Guard::anywhere();
    by = {std::ldexp(by.a, shift), std::ldexp(by.b, shift), std::ldexp(by.c, shift)};
    return guard;
}

}  // namespace liftmesh
