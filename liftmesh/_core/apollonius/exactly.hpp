// Disks as exact integers relative to the first of them, in the least type that holds what the
// polynomials make of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "apollonius/disk.hpp"
#include "apollonius/integer.hpp"
#include "apollonius/polynomials.hpp"
#include "predicates/lattice.hpp"

namespace liftmesh::apollonius {

// The disks of one call on their common lattice.
template <std::size_t K>
class OnLattice {
 public:
    // `may_be_short`: whether polynomials of degree 9 are all that is made of them.
    explicit OnLattice(const std::array<const Disk*, K>& disks, bool may_be_short = true) {
        int low = 1024, high = -1100;
        for (std::size_t i = 0; i < K; ++i) {
            const Disk& d = *disks[i];
            is_infinity_[i] = d.is_infinity;
            part_[i] = {dyadic(d.x), dyadic(d.y), dyadic(d.r)};
            for (const Dyadic& part : part_[i]) {
                if (part.mantissa == 0) continue;
                low = std::min(low, part.exponent);
                high = std::max(high, part.exponent + bit_length(part.mantissa));
            }
        }
        low_ = low;
        fits_a_word_ = high - low <= 62;
        is_short_ = may_be_short && fits_a_word_ && are_differences_short();
    }

    // Calls work(row), where row(i) is the i-th disk relative to the first.
    template <class Work>
    auto visit(Work work) const {
        return is_short_ ? work([this](std::size_t i) { return short_row(i); })
                         : work([this](std::size_t i) { return long_row(i); });
    }

 private:
    // Polynomials of degree 9 in integers of 13 bits fit 128.
    static constexpr std::int64_t longest = 1 << 13;

    std::int64_t word(std::size_t i, std::size_t column) const {
        const Dyadic& part = part_[i][column];
        return part.mantissa == 0 ? 0 : part.mantissa * (std::int64_t{1} << (part.exponent - low_));
    }
    bool are_differences_short() const {
        for (std::size_t i = 1; i < K; ++i)
            for (std::size_t column = 0; column < 3; ++column) {
                const std::int64_t more = word(i, column) - word(0, column);
                if (!is_infinity_[i] && (more > longest || more < -longest)) return false;
            }
        return true;
    }

    Relative<Int128> short_row(std::size_t i) const {
        if (is_infinity_[i]) return {0, 0, 0, 1};
        const auto more = [&](std::size_t column) -> Int128 {
            return word(i, column) - word(0, column);
        };
        return {more(0), more(1), more(2), power_of(more(0), more(1), more(2))};
    }

    Integer long_difference(std::size_t i, std::size_t column) const {
        if (fits_a_word_) return {word(i, column) - word(0, column), 0};
        const auto whole = [&](const Dyadic& d) {
            return d.mantissa == 0 ? Integer() : Integer(d.mantissa, d.exponent - low_);
        };
        return whole(part_[i][column]) - whole(part_[0][column]);
    }
    Relative<Integer> long_row(std::size_t i) const {
        if (is_infinity_[i]) return {{}, {}, {}, {1, 0}};
        const Integer x = long_difference(i, 0), y = long_difference(i, 1);
        const Integer r = long_difference(i, 2);
        return {x, y, r, power_of(x, y, r)};
    }

    std::array<std::array<Dyadic, 3>, K> part_;
    std::array<bool, K> is_infinity_;
    int low_;
    bool fits_a_word_, is_short_;
};

inline int sign_of(Int128 value) {
    return value > 0 ? 1 : value < 0 ? -1 : 0;
}
inline int sign_of(const Integer& value) {
    return value.sign();
}

// Of |even| - |odd| root.
inline int compare_squares(const Surd<Integer>& s, const Integer& radicand) {
    return Integer::compare_magnitudes(s.even * s.even, s.odd * s.odd * radicand);
}
inline int compare_squares(const Surd<Int128>& s, Int128 radicand) {
    constexpr Int128 half = Int128{1} << 63;
    if (s.odd < half && s.odd > -half)
        return sign_of_difference(s.even, s.even, s.odd * s.odd, radicand);
    return compare_squares(Surd<Integer>{Integer(s.even), Integer(s.odd)}, Integer(radicand));
}

template <class Number>
int sign_of(const Surd<Number>& s, const Number& radicand) {
    const int even = sign_of(s.even), odd = sign_of(s.odd);
    if (even == odd || odd == 0) return even;
    if (even == 0) return odd;
    return even * compare_squares(s, radicand);
}

// The square of `root`: the product of the powers of p, q and r with respect to each other, of
// which those with infinity are 1.
template <class Number>
Number radicand(const Relative<Number>& q, const Relative<Number>& r, bool r_is_infinity) {
    if (r_is_infinity) return q.power;
    return q.power * r.power * power_of<Number>(q.x - r.x, q.y - r.y, q.r - r.r);
}

}  // namespace liftmesh::apollonius
