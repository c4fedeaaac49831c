#include "predicates/crossings.hpp"

#include "base/double_word.hpp"
#include "base/floating_point.hpp"
#include "predicates/determinants.hpp"
#include "predicates/lattice.hpp"

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

// On which side of the middle of two numbers a coordinate of the crossing is, in integers.
int side_of_middle(const double* pair, std::size_t axis, double low, double high) {
    std::array<double, 10> values;
    std::copy_n(pair, 8, values.begin());
    values[8] = low;
    values[9] = high;
    const Lattice<10> lattice(values);
    return at_width_of(lattice, [&]<int N>() {
        const auto at = [&](std::size_t i) { return lattice.at<N>(static_cast<int>(i)); };
        const auto step = [&](std::size_t from, std::size_t to, std::size_t k) {
            return at(2 * to + k) - at(2 * from + k);
        };
        const auto cross = [&](std::size_t from, std::size_t to) {  // with c d
            return step(2, 3, 0) * step(from, to, 1) - step(2, 3, 1) * step(from, to, 0);
        };
        const Wide<2 * N> above = cross(2, 0), whole = cross(1, 0);
        const Wide<N> gap = at(axis) - at(8) + (at(axis) - at(9)), edge = step(0, 1, axis);
        const Wide<3 * N> share = edge * above;
        return (gap * whole + share + share).sign() * whole.sign();
    });
}

// The double nearest to a coordinate, ties to even, among those within the error of a double word.
double rounded(const double* pair, std::size_t axis, double high, double low, double error) {
    const double reach = error + 0x1p-50 * std::fabs(low);
    double least = high + (low - reach), greatest = high + (low + reach);
    if (least == greatest) return high;
    if (least <= 0 && greatest >= 0) {
        const int side = side_of_middle(pair, axis, 0, 0);
        if (side == 0) return 0;
        (side > 0 ? least : greatest) = side > 0 ? 0.0 : -0.0;
    }
    const double sign = std::copysign(1.0, greatest);
    const auto [nearer, farther] = std::minmax({std::fabs(least), std::fabs(greatest)});
    auto from = std::bit_cast<std::uint64_t>(nearer), to = std::bit_cast<std::uint64_t>(farther);
    while (from < to) {
        const std::uint64_t middle = from + (to - from) / 2;
        const double below = sign * std::bit_cast<double>(middle),
                     above = sign * std::bit_cast<double>(middle + 1),
                     side = sign * side_of_middle(pair, axis, below, above);
        if (side > 0 || (side == 0 && middle % 2 == 1))
            from = middle + 1;
        else
            to = middle;
    }
    return sign * std::bit_cast<double>(from);
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
    if (is_certain({centre, error})) return {point(centre.high), point(centre.low)};
    const Point place{rounded(pair, 0, centre.high[0], centre.low[0], error[0]),
                      rounded(pair, 1, centre.high[1], centre.low[1], error[1])};
    const Pair left = centre.high - Pair{place.x, place.y};  // they are near to each other
    return {place, point(left + centre.low)};
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
