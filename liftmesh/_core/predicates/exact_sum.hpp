// The sign of a sum of products, in exact integers of any width.
//
// A product of few mantissas is short, wherever its lowest bit stands: adding it touches the limbs
// that it has, and those that a carry reaches. (The difference of two numbers far apart is long,
// and products of differences are longer.) Terms of either sign are added up by themselves.
#pragma once

#include "predicates/lattice.hpp"
#include "predicates/wide.hpp"

namespace liftmesh {

// A product of factors on a lattice: 0, or its sign and magnitude, whose lowest bit stands for
// 2^shift.
template <int N>
struct Term {
    Wide<N> magnitude;
    int shift;
    bool negative;
};

inline Term<2> operator*(const Dyadic& a, const Dyadic& b) {
    const auto size = [](std::int64_t m) { return static_cast<std::uint64_t>(m < 0 ? -m : m); };
    const Uint128 product = static_cast<Uint128>(size(a.mantissa)) * size(b.mantissa);
    return {{static_cast<std::uint64_t>(product), static_cast<std::uint64_t>(product >> 64)},
            a.exponent + b.exponent,
            (a.mantissa < 0) != (b.mantissa < 0)};
}

inline Term<1> one_factor(const Dyadic& a) {
    return {{static_cast<std::uint64_t>(a.mantissa < 0 ? -a.mantissa : a.mantissa)},
            a.exponent,
            a.mantissa < 0};
}

template <int N, int M>
Term<N + M> operator*(const Term<N>& a, const Term<M>& b) {
    return {unsigned_product(a.magnitude, b.magnitude), a.shift + b.shift,
            a.negative != b.negative};
}

// A number with its exponent apart, in units of a lattice.
struct Magnitude {
    double mantissa;  // with its sign, below 2^128
    int exponent;
};

// Of terms with `Factors` factors, each an integer of at most `width` bits.
template <int Factors>
class ExactSum {
 public:
    explicit ExactSum(int width) : limbs_(Factors * width / 64 + spare) {
        for (auto& sum : sum_) std::fill_n(sum, limbs_, 0);
    }

    template <int N>
    void add(const Term<N>& term) {
        accumulate(term, term.negative);
    }
    template <int N>
    void subtract(const Term<N>& term) {
        accumulate(term, !term.negative);
    }

    int sign() const {
        for (int i = limbs_ - 1; i >= 0; --i)
            if (sum_[0][i] != sum_[1][i]) return sum_[0][i] > sum_[1][i] ? 1 : -1;
        return 0;
    }

    // The sum, rounded: an error of a few units in the last place.
    Magnitude magnitude() const {
        const int turn = sign();
        if (turn == 0) return {0, 0};
        std::uint64_t lead[2] = {};  // the highest limbs of the difference
        int top = 0;
        bool borrow = false;
        for (int i = 0; i < limbs_; ++i) {
            const std::uint64_t more = sum_[turn < 0][i], less = sum_[turn > 0][i];
            const std::uint64_t limb = more - less - borrow;
            borrow = less > more || (borrow && less == more);
            if (limb == 0) continue;
            lead[1] = i > 0 && top == i - 1 ? lead[0] : 0;
            lead[0] = limb;
            top = i;
        }
        const double mantissa =
            std::ldexp(static_cast<double>(lead[0]), 64) + static_cast<double>(lead[1]);
        return {turn * mantissa, 64 * (top - 1)};
    }

 private:
    static constexpr int widest = 2098;  // the bits of every finite double
    // For the limbs of a term beyond its highest bit, and the carries of up to 512 terms.
    static constexpr int spare = 6;

    template <int N>
    void accumulate(const Term<N>& term, bool negative) {
        static_assert(N < spare);
        std::uint64_t* limb = sum_[negative] + term.shift / 64;
        Uint128 carry = 0;
        for (int i = 0; i < N; ++i, ++limb) {
            carry += static_cast<Uint128>(term.magnitude.limb[i]) << term.shift % 64;
            carry += *limb;
            *limb = static_cast<std::uint64_t>(carry);
            carry >>= 64;
        }
        for (; carry != 0; ++limb) {
            carry += *limb;
            *limb = static_cast<std::uint64_t>(carry);
            carry >>= 64;
        }
    }

    int limbs_;
    std::uint64_t sum_[2][Factors * widest / 64 + spare];
};

}  // namespace liftmesh
