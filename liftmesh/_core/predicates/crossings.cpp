#include "predicates/crossings.hpp"

#include "base/double_word.hpp"
#include "base/floating_point.hpp"
#include "predicates/determinants.hpp"

namespace liftmesh {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr EdgeCrossing unknown{{none, none}, {none, none}};

// Whether no product of differences overflows, nor loses bits below the range.
bool is_in_window(const double* pair) {
    return std::all_of(pair, pair + 8, [](double each) {
        const double size = std::fabs(each);
        return size == 0 || (size > 0x1p-200 && size < 0x1p200);
    });
}

// The edges are a b and c d; from a, the share (d - c) x (a - c) / (b - a) x (d - c) of a b.
//
// Bounds, with u = 2^-53: a product of exact differences is off by 5 u^2 of it, so the determinants
// by 8 u^2 of the magnitudes of their products; the share by 15 u^2 of it more, and less than 16
// u^2 of these magnitudes over the denominator, where that is not off by an eighth. Its product
// with b - a and the sum with a add 5 u^2 and 2 u^2.
EdgeCrossing crossing(const double* pair) {
    const Pair a{pair[0], pair[1]}, b{pair[2], pair[3]}, c{pair[4], pair[5]}, d{pair[6], pair[7]};
    const auto edge = exact_difference(b, a), other = exact_difference(d, c);
    const auto above = other * swapped(exact_difference(a, c)), whole = other * swapped(edge);
    const auto numerator = first(above) - second(above), denominator = second(whole) - first(whole);
    const Pair sizes = magnitudes(above.high), of_whole = magnitudes(whole.high);
    const double size = std::fabs(denominator.high), largest = of_whole[0] + of_whole[1];
    if (!(0x1p-100 * largest < size)) return unknown;
    const auto share = numerator / denominator;
    const auto centre = a + both(share) * edge;
    const double off = 0x1p-98 * ((sizes[0] + sizes[1] + std::fabs(share.high) * largest) / size);
    const Pair error = off * magnitudes(edge.high) + 0x1p-103 * magnitudes(centre.high);
    if (!is_certain({centre, error})) return unknown;
    return {point(centre.high), point(centre.low)};
}

double distance(Point a, Point b, Point p) {
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const auto scaled = std::isfinite(length)
                            ? Scaled::of(length, 0)
                            : Scaled::of(std::hypot(b.x / 2 - a.x / 2, b.y / 2 - a.y / 2), 1);
    const Scaled found = turn(a, b, p) / scaled;
    return std::ldexp(std::fabs(found.mantissa), found.exponent);
}

}  // namespace

EdgeCrossing crossing_of(const double* pair) {
    if (!is_in_window(pair)) return unknown;
    const auto [place, residual] = crossing(pair);
    return {{place.x + 0.0, place.y + 0.0}, residual};  // no -0.0
}

void find_crossings(const double* pairs, std::size_t count, double* places) {
    const IeeeArithmetic ieee;
    for (std::size_t i = 0; i < count; ++i) {
        const Point found = crossing_of(pairs + 8 * i).place;
        places[2 * i] = found.x;
        places[2 * i + 1] = found.y;
    }
}

void find_distances(const double* edges_and_points, std::size_t count, double* distances) {
    const IeeeArithmetic ieee;
    for (std::size_t i = 0; i < count; ++i) {
        const double* at = edges_and_points + 6 * i;
        distances[i] = distance({at[0], at[1]}, {at[2], at[3]}, {at[4], at[5]});
    }
}

}  // namespace liftmesh
