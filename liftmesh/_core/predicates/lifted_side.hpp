// Exact signs of lifted points, for every lift and all finite doubles. They are called where a
// filter is inconclusive.
#pragma once

#include "predicates/incircle.hpp"
#include "predicates/lift.hpp"

namespace liftmesh {

// The side test: for counter-clockwise a, b, c, +1 where the lift of d is below the plane of their
// lifts, -1 above, 0 on it.
template <class Lift>
int lifted_side_exact(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                      const Lifted<Lift>& c, const Lifted<Lift>& d, Guard guard);

// The same, but a point on the plane is decided by the symbolic perturbation that lifts
// lexicographically larger points more. Never 0 where a, b, c turn and d is at none of them.
template <class Lift>
int lifted_side_canonical_exact(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                                const Lifted<Lift>& c, const Lifted<Lift>& d, Guard guard);

// For lifts without values.
inline int side_canonical_exact(Paraboloid, Point a, Point b, Point c, Point d, Guard guard) {
    return incircle_canonical_exact(a, b, c, d, guard);
}
inline int side_canonical_exact(Farthest, Point a, Point b, Point c, Point d, Guard guard) {
    const int sign = incircle_exact(a, b, c, d, guard);
    return sign != 0 ? -sign : perturbed_sign(a, b, c, d);
}
inline int side_canonical_exact(const ByMetric& by, Point a, Point b, Point c, Point d,
                                Guard guard) {
    return lifted_side_canonical_exact<ByMetric>(by, {a, {}}, {b, {}}, {c, {}}, {d, {}}, guard);
}

// Of three distinct points on one line with b between the others, where the lift of b is: 1 above
// the segment between the lifts of a and c, 0 on it, -1 below.
template <class Lift>
int height_between(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                   const Lifted<Lift>& c);

// A point on the segment is a vertex: the perturbation lifts an end of the segment most.
template <class Lift>
bool is_hidden_between(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                       const Lifted<Lift>& c) {
    return height_between(lift, a, b, c) > 0;
}

// Of three distinct points on one line, in any order.
template <class Lift>
bool is_between_and_hidden(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                           const Lifted<Lift>& c) {
    const bool is_between = before_xy(a.point, b.point) == before_xy(b.point, c.point);
    return is_between && is_hidden_between(lift, a, b, c);
}

}  // namespace liftmesh
