// The double nearest to a number that is known by comparisons only, or the least that is not less.
//
// Doubles are numbered in ascending order: 0 is number 0, the least positive one number 1, infinity
// the last. Between consecutive ones lies a midpoint, at which the result changes, and at which the
// even one of the two is taken, as by IEEE 754. The midpoint before infinity lies where 2^1024
// would be the next double.
#pragma once

#include "predicates/lattice.hpp"

namespace liftmesh {

using NumberOfDouble = std::int64_t;
inline constexpr NumberOfDouble number_of_infinity = 0x7ff0000000000000;

inline NumberOfDouble number_of(double value) {
    const auto size = static_cast<NumberOfDouble>(std::bit_cast<std::uint64_t>(std::fabs(value)));
    return value < 0 ? -size : size;
}

inline double double_of(NumberOfDouble number) {
    const double size = std::bit_cast<double>(static_cast<std::uint64_t>(std::abs(number)));
    return number < 0 ? -size : size;
}

// A double of a number as an exact value, in which infinity is 2^1024.
inline Dyadic value_of(NumberOfDouble number) {
    if (std::abs(number) == number_of_infinity) return {number < 0 ? -1 : 1, 1024};
    return dyadic(double_of(number));
}

// The first number that the value is not beyond; is_beyond(number) need not hold or fail outside of
// the doubles. The search begins at a finite double near the value.
template <class IsBeyond>
double first_not_beyond(double near, IsBeyond is_beyond_double) {
    const auto is_beyond = [&](NumberOfDouble number) {
        if (number >= number_of_infinity) return false;
        return number < -number_of_infinity || is_beyond_double(number);
    };
    // The value is beyond `below`, and not beyond `found`.
    constexpr NumberOfDouble most = number_of_infinity, widest = NumberOfDouble{1} << 61;
    NumberOfDouble below = number_of(near), found = below, step = 1;
    if (is_beyond(found)) {
        for (++found; is_beyond(found); step = std::min(2 * step, widest)) {
            below = found;
            found = found > most - step ? most : found + step;
        }
    } else {
        for (--below; !is_beyond(below); step = std::min(2 * step, widest)) {
            found = below;
            below = below < step - most ? -most - 1 : below - step;
        }
    }
    while (found - below > 1) {
        const NumberOfDouble middle = below + (found - below) / 2;
        (is_beyond(middle) ? below : found) = middle;
    }
    return double_of(found);
}

// `side(number)` is the sign of the value minus the midpoint of this double and the next one.
template <class Side>
double nearest_double(double near, Side side) {
    return first_not_beyond(near, [&](NumberOfDouble number) {
        const int sign = side(number);
        return sign > 0 || (sign == 0 && number % 2 != 0);
    });
}

// A lattice that also holds two doubles, whose middle something is compared with.
template <class Points>
class WithMiddle : public Points {
 public:
    template <class... Given>
    WithMiddle(Dyadic lower, Dyadic upper, const Given&... given)
        : Points(given...), ends_{lower, upper} {
        for (const Dyadic& end : ends_)
            if (end.mantissa != 0)
                this->include(end.exponent, end.exponent + bit_length(end.mantissa));
        for (Dyadic& end : ends_)
            if (end.mantissa != 0) end.exponent -= this->low();
    }

    const Dyadic (&ends() const)[2] { return ends_; }
    template <int N>
    Wide<N> sum_of_ends() const {
        return shifted<N>(ends_[0].mantissa, ends_[0].exponent) +
               shifted<N>(ends_[1].mantissa, ends_[1].exponent);
    }

 private:
    Dyadic ends_[2];
};

inline double finite_near(double value) {
    constexpr double largest = std::numeric_limits<double>::max();
    return std::isnan(value) ? 0.0 : std::clamp(value, -largest, largest);
}

}  // namespace liftmesh
