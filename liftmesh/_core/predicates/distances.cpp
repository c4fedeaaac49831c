#include "predicates/distances.hpp"

#include "base/input.hpp"
#include "predicates/circumradius.hpp"
#include "predicates/fixed_point.hpp"
#include "predicates/nearest_double.hpp"
#include "predicates/space_lattice.hpp"

namespace liftmesh {

namespace {

int sign_of_whole(Int128 value) {
    return (value > 0) - (value < 0);
}

SpacePoint on_ground(Point p) {
    return {p.x, p.y, 0};
}

// Below 2^125.
Int128 square_of_step(const FixedPoint<4>& points, int from, int to) {
    const Step step = points.step(from, to);
    return dot(step, step);
}

// With S for the squares, |ab| < |ap| + |bq| where S_ab - S_ap - S_bq < 2 sqrt(S_ap S_bq). All
// integers are below 2^127.
bool do_whole_circles_cross(const FixedPoint<4>& points) {
    const Int128 of_p = square_of_step(points, 0, 1), of_q = square_of_step(points, 2, 3);
    const Int128 rest = square_of_step(points, 0, 2) - of_p - of_q;
    return rest < 0 || sign_of_difference(rest, rest, 2 * of_p, 2 * of_q) < 0;
}

bool do_circles_cross_exact(Point a, Point p, Point b, Point q) {
    if (const FixedPoint<4> points({a, p, b, q}); points.fits())
        return do_whole_circles_cross(points);
    const SpaceLattice<4> lattice({on_ground(a), on_ground(p), on_ground(b), on_ground(q)});
    return at_width_of(lattice, [&]<int N>() {
        const auto of_p = square(lattice.template step<N>(0, 1));
        const auto of_q = square(lattice.template step<N>(2, 3));
        const auto rest = square(lattice.template step<N>(0, 2)) - of_p - of_q;
        return rest.negative() || (rest * rest - (of_p + of_p) * (of_q + of_q)).sign() < 0;
    });
}

// Below 2^-1020: in units of the least double, of which all are multiples.
double tiny_distance(Point a, Point b, double not_less) {
    const auto units = [](double value) { return whole(std::ldexp(value, 1074)); };
    const Int128 x = units(a.x - b.x), y = units(a.y - b.y);
    return nearest_double(not_less, [&](NumberOfDouble number) {
        const Int128 twice_middle = units(double_of(number)) + units(double_of(number + 1));
        if (twice_middle < 0) return 1;
        return sign_of_whole(4 * (x * x + y * y) - twice_middle * twice_middle);
    });
}

}  // namespace

int compare_distances_exact(Point a, Point b, Point c, Point d) {
    if (const FixedPoint<4> points({a, b, c, d}); points.fits())
        return sign_of_whole(square_of_step(points, 0, 1) - square_of_step(points, 2, 3));
    const SpaceLattice<4> lattice({on_ground(a), on_ground(b), on_ground(c), on_ground(d)});
    return at_width_of(lattice, [&]<int N>() {
        return (square(lattice.template step<N>(0, 1)) - square(lattice.template step<N>(2, 3)))
            .sign();
    });
}

int sign_at_apex_exact(Point a, Point b, Point c) {
    if (const FixedPoint<3> points({a, b, c}); points.fits())
        return sign_of_whole(dot(points.step(2, 0), points.step(2, 1)));
    const SpaceLattice<3> lattice({on_ground(a), on_ground(b), on_ground(c)});
    return at_width_of(lattice, [&]<int N>() {
        return dot(lattice.template step<N>(0, 2), lattice.template step<N>(1, 2)).sign();
    });
}

namespace {

// Of squares of distances, the sum of which is in the window; nothing if rounding may decide. In
// units of that sum, they are off by 4 e each: the rest errs by 7 e, its square by 15 e, and four
// times the product of the two others by 9 e.
std::optional<bool> cross_surely(double of_p, double of_q, double of_ends) {
    const double rest = of_ends - of_p - of_q, sum = of_ends + of_p + of_q;
    const double error = 32 * unit_roundoff * sum;
    if (rest < -error) return true;
    const double difference = rest * rest - 4 * of_p * of_q;
    if (std::fabs(difference) > error * sum) return rest < 0 || difference < 0;
    return {};
}

// Outside of the window: of steps that are scaled so that the longest is near 1. What underflows is
// far less than the error.
std::optional<bool> cross_surely_scaled(Point a, Point p, Point b, Point q) {
    const Point steps[] = {{p.x - a.x, p.y - a.y}, {q.x - b.x, q.y - b.y}, {b.x - a.x, b.y - a.y}};
    double longest = 0;
    for (const Point& each : steps)
        longest = std::max({longest, std::fabs(each.x), std::fabs(each.y)});
    if (!(longest > 0 && std::isfinite(longest))) return {};
    const auto square = [shift = -std::ilogb(longest)](Point step) {
        const double x = std::ldexp(step.x, shift), y = std::ldexp(step.y, shift);
        return x * x + y * y;
    };
    return cross_surely(square(steps[0]), square(steps[1]), square(steps[2]));
}

}  // namespace

bool do_circles_cross(Point a, Point p, Point b, Point q) {
    const double of_p = square_of_distance(a, p), of_q = square_of_distance(b, q),
                 of_ends = square_of_distance(a, b), sum = of_ends + of_p + of_q;
    const std::optional<bool> sure = sum > least_square && sum < greatest_square
                                         ? cross_surely(of_p, of_q, of_ends)
                                         : cross_surely_scaled(a, p, b, q);
    return sure ? *sure : do_circles_cross_exact(a, p, b, q);
}

double distance(Point a, Point b) {
    const double not_less = std::fabs(a.x - b.x) + std::fabs(a.y - b.y);
    if (not_less < 0x1p-1020) return tiny_distance(a, b, not_less);
    if (!is_finite(a) || !is_finite(b)) return not_less;  // as another thread may have written
    return 2 * circumradius<2>({on_ground(a), on_ground(b)}, RadiusRounding::nearest);
}

}  // namespace liftmesh
