#include "predicates/circumcentre.hpp"

#include "base/double_word.hpp"
#include "predicates/circumscribed.hpp"
#include "predicates/nearest_double.hpp"

namespace liftmesh {

namespace {

// With q towards the centre from the last corner p, and the volume d, the centre is p + q / 2 d.

struct RoundedCentre {
    DoubleWord<double> at[3];
    double error[3];
};

// In double words, where u = 2^-53 and L is the longest step: as for radii, components of q err by
// 87 u^2 L^4 and d by 25 u^2 L^3, the quotient by 15 u^2 and the sum by 2 u^2 of what they are. The
// constants are a little larger than half of these, as the quotient is halved, and than the others,
// for terms of u^3.
RoundedCentre rounded_centre(const Corners<4>& corners, double square_of_length) {
    const auto at = steps_of<DoubleWord<double>, 4>([&](unsigned to, unsigned from) {
        const SpacePoint &p = corners[to], &q = corners[from];
        return Vector<DoubleWord<double>>{exact_difference(p.x, q.x), exact_difference(p.y, q.y),
                                          exact_difference(p.z, q.z)};
    });
    const auto [x, y, z] = towards_centre(at);
    const DoubleWord<double> d = volume(at);
    const double size = std::fabs(d.high);
    const double cube = square_of_length * std::sqrt(square_of_length);
    const bool is_far_from_zero = size > 0x1p-90 * cube;
    const SpacePoint& p = corners[3];
    const auto sum = [&](double origin, const DoubleWord<double>& q) {
        const DoubleWord<double> step = q / d * 0.5;
        const DoubleWord<double> centre = origin + step;
        const double reach = std::fabs(step.high);
        const double error =
            0x1p-106 * ((45 * square_of_length * square_of_length + 26 * cube * reach) / size +
                        16 * reach + 3 * std::fabs(centre.high));
        return std::pair{centre, error};
    };
    RoundedCentre found;
    const std::pair<DoubleWord<double>, double> sums[3] = {sum(p.x, x), sum(p.y, y), sum(p.z, z)};
    for (int axis = 0; axis < 3; ++axis) {
        found.at[axis] = sums[axis].first;
        found.error[axis] = is_far_from_zero ? sums[axis].second + 0x1p-1000 : HUGE_VAL;
    }
    return found;
}

// The sign of a coordinate minus the middle of two doubles. The sum of these, and twice a corner,
// are below 2^(64N - 2), q and d times their difference below 2^(256N - 3).
int side_of_middle(const Corners<4>& corners, unsigned axis, Dyadic lower, Dyadic upper) {
    const WithMiddle<SpaceLattice<4>> lattice(lower, upper, corners);
    return at_width_of(lattice, [&]<int N>() {
        const auto at = steps_of<Wide<N>, 4>(
            [&](int to, int from) { return lattice.template step<N>(to, from); });
        const Wide<3 * N> d = volume(at);
        const auto [x, y, z] = towards_centre(at);
        const Wide<4 * N>& q = axis == 0 ? x : axis == 1 ? y : z;
        const Wide<N> p = lattice.template at<N>(static_cast<int>(9 + axis));
        const Wide<N> m = lattice.template sum_of_ends<N>() - (p + p);
        return d.sign() * (q - d * m).sign();
    });
}

[[gnu::noinline]] double exact_coordinate(const Corners<4>& corners, unsigned axis, double near) {
    if (side_of_middle(corners, axis, {}, {}) == 0) return 0;
    return nearest_double(finite_near(near), [&](NumberOfDouble number) {
        return side_of_middle(corners, axis, value_of(number), value_of(number + 1));
    });
}

// Times a power of two: whether nothing was lost.
bool scale(Corners<4>& corners, int shift) {
    bool is_exact = true;
    for (SpacePoint& p : corners)
        for (double* value : {&p.x, &p.y, &p.z}) {
            const double scaled = std::ldexp(*value, shift);
            is_exact &= std::isfinite(scaled) && std::ldexp(scaled, -shift) == *value;
            *value = scaled;
        }
    return is_exact;
}

// Outside the window corners are scaled so that the longest step is near 1.
[[gnu::noinline]] SpacePoint scaled_centre(const Corners<4>& corners) {
    const int shift =
        has_finite_steps<4>(corners) ? -exponent_of_greatest(plain_steps<4>(corners)) : -1024;
    Corners<4> scaled = corners;
    const bool is_exact = scale(scaled, shift);
    const double length = square_of_greatest_step(plain_steps<4>(scaled));
    const RoundedCentre found = rounded_centre(scaled, length);
    double centre[3];
    for (unsigned axis = 0; axis < 3; ++axis) {
        const double high = found.at[axis].high, near = std::ldexp(high, -shift);
        const double size = std::fabs(near);
        const bool is_certain = is_exact && rounds_to_high(found.at[axis], found.error[axis]) &&
                                size > 0x1p-1021 && size < 0x1p1023;
        centre[axis] = is_certain ? near : exact_coordinate(corners, axis, near);
    }
    return {centre[0], centre[1], centre[2]};
}

}  // namespace

SpacePoint circumcentre(const Corners<4>& corners) {
    const double length = square_of_greatest_step(plain_steps<4>(corners));
    if (!(length > least_square && length < greatest_square)) return scaled_centre(corners);
    const RoundedCentre found = rounded_centre(corners, length);
    const auto coordinate = [&](unsigned axis) {
        const DoubleWord<double>& at = found.at[axis];
        return rounds_to_high(at, found.error[axis]) ? at.high
                                                     : exact_coordinate(corners, axis, at.high);
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
}

}  // namespace liftmesh
