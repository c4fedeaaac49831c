// Disks as exact integers relative to the first of them, in the smallest type that holds the values
// of the polynomials.
#pragma once

#include "apollonius/disk.hpp"
#include "apollonius/polynomials.hpp"
#include "predicates/lattice.hpp"
#include "predicates/wide.hpp"

namespace liftmesh::apollonius {

// Signed integers of up to a fixed number of limbs, as sign and magnitude: only the limbs in use
// are touched, so short numbers are cheap and nothing is allocated.

class Integer {
 public:
    // A polynomial of degree 18 in integers of 257 bits, with its few additions, and a spare limb.
    static constexpr int capacity = 76;

    Integer() = default;
    Integer(const Integer& other) { *this = other; }
    Integer& operator=(const Integer& other) {
        limbs_ = other.limbs_;
        negative_ = other.negative_;
        std::copy_n(other.limb_, limbs_, limb_);
        return *this;
    }

    // mantissa * 2^shift
    Integer(std::int64_t mantissa, int shift) : negative_(mantissa < 0) {
        if (mantissa == 0) return;
        const auto size = static_cast<std::uint64_t>(negative_ ? -mantissa : mantissa);
        const int whole = shift / 64, part = shift % 64;
        std::fill_n(limb_, whole, 0);
        limb_[whole] = size << part;
        limbs_ = whole + 1;
        if (part != 0 && size >> (64 - part) != 0) limb_[limbs_++] = size >> (64 - part);
        trim();
    }

    explicit Integer(Int128 value) : limbs_(2), negative_(value < 0) {
        const auto size = static_cast<Uint128>(negative_ ? -value : value);
        limb_[0] = static_cast<std::uint64_t>(size);
        limb_[1] = static_cast<std::uint64_t>(size >> 64);
        trim();
    }

    int sign() const { return limbs_ == 0 ? 0 : negative_ ? -1 : 1; }

    // Out of line, as these are called in many places: a compiler inlines them for a long time.
    [[gnu::noinline]] friend Integer operator*(const Integer& a, const Integer& b) {
        Integer product;
        if (a.limbs_ == 0 || b.limbs_ == 0) return product;
        product.limbs_ = a.limbs_ + b.limbs_;
        product.negative_ = a.negative_ != b.negative_;
        std::fill_n(product.limb_, product.limbs_, 0);
        for (int i = 0; i < a.limbs_; ++i) {
            std::uint64_t carry = 0;
            for (int j = 0; j < b.limbs_; ++j) {
                const Uint128 sum =
                    static_cast<Uint128>(a.limb_[i]) * b.limb_[j] + product.limb_[i + j] + carry;
                product.limb_[i + j] = static_cast<std::uint64_t>(sum);
                carry = static_cast<std::uint64_t>(sum >> 64);
            }
            product.limb_[i + b.limbs_] = carry;
        }
        product.trim();
        return product;
    }

    friend Integer operator+(const Integer& a, const Integer& b) { return sum(a, b, b.negative_); }
    friend Integer operator-(const Integer& a, const Integer& b) { return sum(a, b, !b.negative_); }

    // The sign of |a| - |b|.
    static int compare_magnitudes(const Integer& a, const Integer& b) {
        if (a.limbs_ != b.limbs_) return a.limbs_ < b.limbs_ ? -1 : 1;
        for (int i = a.limbs_ - 1; i >= 0; --i)
            if (a.limb_[i] != b.limb_[i]) return a.limb_[i] < b.limb_[i] ? -1 : 1;
        return 0;
    }

 private:
    // a + b, where b counts as negative or not.
    [[gnu::noinline]] static Integer sum(const Integer& a, const Integer& b, bool b_is_negative) {
        if (a.negative_ == b_is_negative) {
            Integer result = a.limbs_ >= b.limbs_ ? added(a, b) : added(b, a);
            result.negative_ = b_is_negative;
            return result;
        }
        const int order = compare_magnitudes(a, b);
        if (order == 0) return {};
        Integer result = order > 0 ? subtracted(a, b) : subtracted(b, a);
        result.negative_ = order > 0 ? a.negative_ : b_is_negative;
        return result;
    }

    static Integer added(const Integer& longer, const Integer& shorter) {
        Integer result;
        std::uint64_t carry = 0;
        for (int i = 0; i < longer.limbs_; ++i) {
            const Uint128 both = static_cast<Uint128>(longer.limb_[i]) + shorter.at(i) + carry;
            result.limb_[i] = static_cast<std::uint64_t>(both);
            carry = static_cast<std::uint64_t>(both >> 64);
        }
        result.limbs_ = longer.limbs_;
        if (carry != 0) result.limb_[result.limbs_++] = carry;
        return result;
    }

    static Integer subtracted(const Integer& larger, const Integer& smaller) {
        Integer result;
        std::uint64_t borrow = 0;
        for (int i = 0; i < larger.limbs_; ++i) {
            const Uint128 rest = static_cast<Uint128>(larger.limb_[i]) - smaller.at(i) - borrow;
            result.limb_[i] = static_cast<std::uint64_t>(rest);
            borrow = static_cast<std::uint64_t>(rest >> 64) & 1;
        }
        result.limbs_ = larger.limbs_;
        result.trim();
        return result;
    }

    std::uint64_t at(int i) const { return i < limbs_ ? limb_[i] : 0; }
    void trim() {
        while (limbs_ > 0 && limb_[limbs_ - 1] == 0) --limbs_;
    }

    int limbs_ = 0;
    bool negative_ = false;
    std::uint64_t limb_[capacity];

    friend class Rounded;
};

// A double with an exponent of its own, for what is beyond the doubles on the way to one.
class Rounded {
 public:
    explicit Rounded(double value, int exponent = 0) {
        part_ = std::frexp(value, &exponent_);
        exponent_ += exponent;
    }
    explicit Rounded(const Integer& value)
        : Rounded(leading(value), 64 * std::max(value.limbs_ - 2, 0)) {}

    friend Rounded operator*(Rounded a, Rounded b) {
        return Rounded(a.part_ * b.part_, a.exponent_ + b.exponent_);
    }
    friend Rounded operator/(Rounded a, Rounded b) {
        return Rounded(a.part_ / b.part_, a.exponent_ - b.exponent_);
    }
    friend Rounded operator+(Rounded a, Rounded b) {
        if (a.part_ == 0 || (b.part_ != 0 && a.exponent_ < b.exponent_)) std::swap(a, b);
        return Rounded(a.part_ + std::ldexp(b.part_, b.exponent_ - a.exponent_), a.exponent_);
    }
    friend Rounded operator-(Rounded a, Rounded b) { return a + Rounded(-b.part_, b.exponent_); }
    Rounded root() const {
        const int odd = exponent_ & 1;
        return Rounded(std::sqrt(std::ldexp(part_, odd)), (exponent_ - odd) / 2);
    }
    // Times a power of two.
    double times(int exponent) const { return std::ldexp(part_, exponent_ + exponent); }

 private:
    static double leading(const Integer& value) {
        const int n = value.limbs_;
        const double low = n > 1 ? static_cast<double>(value.limb_[n - 2]) : 0,
                     high = n > 0 ? static_cast<double>(value.limb_[n - 1]) : 0;
        const double size = n > 1 ? high * 0x1p64 + low : high;
        return value.negative_ ? -size : size;
    }

    double part_;
    int exponent_;
};

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

    Relative<Integer> long_row(std::size_t i) const {
        if (is_infinity_[i]) return {{}, {}, {}, {1, 0}};
        const Integer x = long_difference(i, 0), y = long_difference(i, 1);
        const Integer r = long_difference(i, 2);
        return {x, y, r, power_of(x, y, r)};
    }
    // Of the power of two that is 1 on the lattice.
    int exponent() const { return low_; }

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
