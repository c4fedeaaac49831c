#include "predicates/exact_weights.hpp"

#include <cmath>

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"

namespace liftmesh {

namespace {

template <int K>
struct Turns : PlanarLattice<K> {
    explicit Turns(const Point (&points)[K]) : PlanarLattice<K>(points) {}
    using PlanarLattice<K>::low;

    Magnitude turn(int a, int b, int c) const {
        ExactSum<2> det(this->width());
        const int cycle[] = {a, b, c};
        for (int i = 0; i < 3; ++i) {
            const int from = cycle[i], to = cycle[(i + 1) % 3];
            det.add(this->part_of_x(from) * this->part_of_y(to));
            det.subtract(this->part_of_y(from) * this->part_of_x(to));
        }
        return det.magnitude();
    }
};

// In units of 1.
Magnitude turn(Point a, Point b, Point c) {
    const Turns<3> turns({a, b, c});
    const Magnitude found = turns.turn(0, 1, 2);
    if (found.mantissa == 0) return found;
    return {found.mantissa, found.exponent + 2 * turns.low()};
}

double quotient(Magnitude part, Magnitude whole) {
    return std::ldexp(part.mantissa / whole.mantissa, part.exponent - whole.exponent);
}

}  // namespace

Weights exact_weights(Point a, Point b, Point c, Point query) {
    const Turns<4> turns({a, b, c, query});
    const Magnitude whole = turns.turn(0, 1, 2);
    return {quotient(turns.turn(0, 3, 2), whole), quotient(turns.turn(0, 1, 3), whole)};
}

Point exact_slopes(const Point (&corners)[3], const double (&heights)[3]) {
    const auto [a, b, c] = corners;
    const auto [za, zb, zc] = heights;
    const Magnitude area = turn(a, b, c);
    return {quotient(turn({za, a.y}, {zb, b.y}, {zc, c.y}), area),
            quotient(turn({a.x, za}, {b.x, zb}, {c.x, zc}), area)};
}

}  // namespace liftmesh
