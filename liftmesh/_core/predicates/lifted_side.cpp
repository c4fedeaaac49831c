#include "predicates/lifted_side.hpp"

#include "predicates/incircle.hpp"
#include "predicates/lifted_determinant.hpp"

namespace liftmesh {

namespace {

// The same height is taken off all four, and changes no side.
template <class Lift>
bool are_lowered_alike(const Lifted<Lift>& a, const Lifted<Lift>& b, const Lifted<Lift>& c,
                       const Lifted<Lift>& d) {
    return (a.value == b.value) & (a.value == c.value) & (a.value == d.value);
}

// Lattice coordinates of three points along the axis on which they differ.
template <class Lift>
Dyadic along(const LiftedLattice<Lift, 3>& lattice, int i, Axis axis) {
    return axis == Axis::x ? lattice.part_of_x(i) : lattice.part_of_y(i);
}

// The turn of the three in their vertical plane.
template <class Lift>
int sign_of_wide_turn(const LiftedLattice<Lift, 3>& lattice, Axis axis) {
    ExactSum<LiftedLattice<Lift, 3>::factors + 1> det(lattice.width());
    for (int i = 0; i < 3; ++i) {
        const Term<1> next = one_factor(along(lattice, (i + 1) % 3, axis));
        const Term<1> after = one_factor(along(lattice, (i + 2) % 3, axis));
        for (const auto& part : lattice.height(i)) {
            det.add(part * after);
            det.subtract(part * next);
        }
    }
    return det.sign();
}

// The same from differences of at most 62 bits: seen from b, the heights of a and c at their
// distances along the axis, of which one is negative.
template <class Lift>
int sign_of_narrow_turn(const LiftedLattice<Lift, 3>& lattice, Axis axis) {
    const Wide<2> lowering = whole(lattice.lowering(1));
    Wide<2> along[3], height[3];
    for (int i : {0, 2}) {
        const Wide<1> dx = lattice.template x<1>(i) - lattice.template x<1>(1);
        const Wide<1> dy = lattice.template y<1>(i) - lattice.template y<1>(1);
        height[i] = dx * dx + dy * dy - (whole(lattice.lowering(i)) - lowering);
        along[i] = axis == Axis::x ? lattice.template x<2>(i) - lattice.template x<2>(1)
                                   : lattice.template y<2>(i) - lattice.template y<2>(1);
    }
    return (height[0] * along[2] - height[2] * along[0]).sign();
}

template <class Lift>
int vertical_turn(const LiftedLattice<Lift, 3>& lattice, Axis axis) {
    if constexpr (Lowers<Lift>)
        if (lattice.template fits<1>()) return sign_of_narrow_turn(lattice, axis);
    return sign_of_wide_turn(lattice, axis);
}

}  // namespace

template <class Lift>
int lifted_side_exact(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                      const Lifted<Lift>& c, const Lifted<Lift>& d, Guard guard) {
    if constexpr (Lowers<Lift>)
        if (are_lowered_alike(a, b, c, d))
            return incircle_exact(a.point, b.point, c.point, d.point, guard);
    const LiftedLattice<Lift, 4> lattice(lift, {a, b, c, d});
    if constexpr (Lowers<Lift>)
        if (lattice.template fits<1>()) return sign_of_side(lattice);
    if constexpr (std::is_same_v<Lift, ByMetric>)
        if (const int sign = sign_of_side_by_metric(lattice); sign != 2) return sign;
    return sign_of_wide_side(lattice);
}

template <class Lift>
int lifted_side_canonical_exact(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                                const Lifted<Lift>& c, const Lifted<Lift>& d, Guard guard) {
    const int sign = lifted_side_exact(lift, a, b, c, d, guard);
    return sign != 0 ? sign : perturbed_sign(a.point, b.point, c.point, d.point);
}

template <class Lift>
int height_between(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b,
                   const Lifted<Lift>& c) {
    const Axis axis = a.point.x != c.point.x ? Axis::x : Axis::y;
    const LiftedLattice<Lift, 3> lattice(lift, {a, b, c});
    const bool ascends = axis == Axis::x ? a.point.x < c.point.x : a.point.y < c.point.y;
    return ascends ? -vertical_turn(lattice, axis) : vertical_turn(lattice, axis);
}

#define LIFTMESH_INSTANCES(Lift)                                                          \
    template int lifted_side_exact(const Lift&, const Lifted<Lift>&, const Lifted<Lift>&, \
                                   const Lifted<Lift>&, const Lifted<Lift>&, Guard);      \
    template int lifted_side_canonical_exact(const Lift&, const Lifted<Lift>&,            \
                                             const Lifted<Lift>&, const Lifted<Lift>&,    \
                                             const Lifted<Lift>&, Guard);                 \
    template int height_between(const Lift&, const Lifted<Lift>&, const Lifted<Lift>&,    \
                                const Lifted<Lift>&);
LIFTMESH_INSTANCES(ByWeight)
LIFTMESH_INSTANCES(ByRadius)
LIFTMESH_INSTANCES(ByMetric)
#undef LIFTMESH_INSTANCES

}  // namespace liftmesh
