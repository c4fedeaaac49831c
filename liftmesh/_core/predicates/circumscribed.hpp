// What radii and centres of circumscribed spheres share: the steps between the corners of a
// simplex, in doubles, double words or integers.
#pragma once

#include "predicates/circumradius.hpp"
#include "predicates/insphere.hpp"
#include "predicates/space_lattice.hpp"

namespace liftmesh {

// The steps from the last corner, and that between the first two.
template <class Number, int K>
struct StepsOf {
    Vector<Number> u, v, w, side;
};

template <class Number, int K, class Step>
StepsOf<Number, K> steps_of(Step step) {
    StepsOf<Number, K> steps{};
    steps.u = step(0, K - 1);
    if constexpr (K > 2) steps.v = step(1, K - 1);
    if constexpr (K == 3) steps.side = step(0, 1);
    if constexpr (K == 4) steps.w = step(2, 3);
    return steps;
}

// From the last corner of a tetrahedron the centre is at this, divided by twice the volume.
template <class Number>
auto towards_centre(const StepsOf<Number, 4>& at) {
    return square(at.u) * cross(at.v, at.w) + square(at.v) * cross(at.w, at.u) +
           square(at.w) * cross(at.u, at.v);
}
template <class Number>
auto volume(const StepsOf<Number, 4>& at) {
    return dot(at.u, cross(at.v, at.w));
}

template <int K>
StepsOf<double, K> plain_steps(const Corners<K>& p) {
    return steps_of<double, K>(
        [&p](unsigned to, unsigned from) { return step_between(p[from], p[to]); });
}

template <int K>
double square_of_greatest_step(const StepsOf<double, K>& at) {
    const double square_of_u = square(at.u);
    if constexpr (K == 2) return square_of_u;
    if constexpr (K == 3) return std::max({square_of_u, square(at.v), square(at.side)});
    return std::max({square_of_u, square(at.v), square(at.w)});
}

template <int K>
bool has_finite_steps(const Corners<K>& corners) {
    const auto [u, v, w, side] = plain_steps<K>(corners);
    return std::isfinite((u.x + u.y + u.z) * 0x1p-9 + (v.x + v.y + v.z) * 0x1p-9 +
                         (w.x + w.y + w.z) * 0x1p-9 + (side.x + side.y + side.z) * 0x1p-9);
}

// Of the largest of magnitudes; 0 if there is none, as where rows were altered meanwhile.
inline int exponent_of_magnitude(double largest) {
    return largest > 0 && std::isfinite(largest) ? std::ilogb(largest) : 0;
}
inline int exponent_of_greatest(const StepsOf<double, 2>& at) {
    return exponent_of_magnitude(largest_magnitude(at.u.x, at.u.y, at.u.z));
}
template <int K>
int exponent_of_greatest(const StepsOf<double, K>& at) {
    double largest = 0;
    for (const Vector<double>* step : {&at.u, &at.v, &at.w})
        largest = std::max(largest, largest_magnitude(step->x, step->y, step->z));
    return exponent_of_magnitude(largest);
}

}  // namespace liftmesh
