#include "predicates/circumradius.hpp"
#include "predicates/space_lattice.hpp"

namespace liftmesh {

namespace {

// From p the ends are seen in an obtuse angle.
int edge_sign_exact(const Corners<3>& all) {
    const SpaceLattice<3> lattice(all);
    return at_width_of(lattice, [&]<int N>() {
        return -dot(lattice.template step<N>(0, 2), lattice.template step<N>(1, 2)).sign();
    });
}

// With the steps u and v from one corner to the others and w to p, n = u x v, and the centre at
// c = (|u|^2 v x n + |v|^2 n x u) / 2 |n|^2, p is inside where |w|^2 < 2 w . c.
template <class Number>
auto triangle_sides(const Vector<Number>& u, const Vector<Number>& v, const Vector<Number>& w) {
    const auto n = cross(u, v);
    const auto direction = square(u) * cross(v, n) + square(v) * cross(n, u);
    return std::pair{square(w) * square(n), dot(w, direction)};
}

// With N limbs for steps, each side is below 2^(384N - 4).
int triangle_sign_exact(const Corners<4>& all) {
    const SpaceLattice<4> lattice(all);
    return at_width_of(lattice, [&]<int N>() {
        const auto [near, far] =
            triangle_sides(lattice.template step<N>(1, 0), lattice.template step<N>(2, 0),
                           lattice.template step<N>(3, 0));
        return (far - near).sign();
    });
}

}  // namespace

// The product of the steps errs by 6 e of the sum of its terms' magnitudes.
bool is_inside_smallest_sphere(const Corners<2>& ends, const SpacePoint& p) {
    const Vector<double> u = step_between(p, ends[0]), v = step_between(p, ends[1]);
    const double x = u.x * v.x, y = u.y * v.y, z = u.z * v.z, product = x + y + z;
    const double error =
        6 * unit_roundoff * (std::fabs(x) + std::fabs(y) + std::fabs(z)) + 0x1p-1060;
    if (product > error) return false;
    if (-product > error) return true;
    return edge_sign_exact({ends[0], ends[1], p}) > 0;
}

// With L the longest of the three steps, n errs by 7 e L^2, v x n and n x u by 9 e L^3 in each
// component, the direction by 32 e L^5, and so both sides by less than 90 e L^6 in all.
bool is_inside_smallest_sphere(const Corners<3>& corners, const SpacePoint& p) {
    const Vector<double> u = step_between(corners[0], corners[1]);
    const Vector<double> v = step_between(corners[0], corners[2]);
    const Vector<double> w = step_between(corners[0], p);
    const double length = std::max({square(u), square(v), square(w)});
    if (length > least_square && length < greatest_square) {
        const auto [near, far] = triangle_sides(u, v, w);
        const double error = 100 * unit_roundoff * length * length * length;
        if (near - far > error) return false;
        if (far - near > error) return true;
    }
    return triangle_sign_exact({corners[0], corners[1], corners[2], p}) > 0;
}

}  // namespace liftmesh
