// Signed integers of a fixed number of 64-bit limbs (two's complement, lowest limb first).
//
// They are the kernel's only exact arithmetic: coordinates are integer multiples of a common power
// of two, so each predicate is an integer polynomial, evaluated at a width that provably holds it.
#pragma once

#include "base/standard.hpp"

namespace liftmesh {

__extension__ using Int128 = __int128;
__extension__ using Uint128 = unsigned __int128;

// A whole double of less than 2^127. By a cast compilers would call their runtime library, which
// not all of them link.
inline Int128 whole(double value) {
    int exponent = 0;
    const auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
    return exponent >= 53 ? Int128{digits} << (exponent - 53) : Int128{digits >> (53 - exponent)};
}

// The nearest double, the even one of two; nor is that a cast.
inline double rounded(Uint128 value) {
    const int past = std::bit_width(static_cast<std::uint64_t>(value >> 64));
    const bool inexact = (value & ((Uint128{1} << past) - 1)) != 0;
    return std::ldexp(static_cast<double>(static_cast<std::uint64_t>(value >> past) | inexact),
                      past);
}

template <int N>
struct Wide {
    std::array<std::uint64_t, N> limb;

    bool negative() const { return static_cast<std::int64_t>(limb[N - 1]) < 0; }

    int sign() const {
        if (negative()) return -1;
        for (std::uint64_t part : limb)
            if (part != 0) return 1;
        return 0;
    }
};

template <int N>
Wide<N> operator-(const Wide<N>& a, const Wide<N>& b) {
    Wide<N> result;
    std::uint64_t borrow = 0;
    for (int i = 0; i < N; ++i) {
        const Uint128 difference = static_cast<Uint128>(a.limb[i]) - b.limb[i] - borrow;
        result.limb[i] = static_cast<std::uint64_t>(difference);
        borrow = static_cast<std::uint64_t>(difference >> 64) & 1;
    }
    return result;
}

template <int N>
Wide<N> operator+(const Wide<N>& a, const Wide<N>& b) {
    Wide<N> result;
    std::uint64_t carry = 0;
    for (int i = 0; i < N; ++i) {
        const Uint128 sum = static_cast<Uint128>(a.limb[i]) + b.limb[i] + carry;
        result.limb[i] = static_cast<std::uint64_t>(sum);
        carry = static_cast<std::uint64_t>(sum >> 64);
    }
    return result;
}

template <int N>
Wide<N> magnitude(const Wide<N>& a) {
    return a.negative() ? Wide<N>{} - a : a;
}

// The product of the limbs, as if they had no sign.
template <int N, int M>
Wide<N + M> unsigned_product(const Wide<N>& p, const Wide<M>& q) {
    Wide<N + M> result{};
    for (int i = 0; i < N; ++i) {
        if (N + M > 5 && p.limb[i] == 0) continue;
        std::uint64_t carry = 0;
        for (int j = 0; j < M; ++j) {
            const Uint128 part =
                static_cast<Uint128>(p.limb[i]) * q.limb[j] + result.limb[i + j] + carry;
            result.limb[i + j] = static_cast<std::uint64_t>(part);
            carry = static_cast<std::uint64_t>(part >> 64);
        }
        result.limb[i + M] = carry;
    }
    return result;
}

// Takes `part`, if it is to be, from the limbs that begin at `first`.
template <int N, int M>
void take_away(Wide<N>& from, int first, const Wide<M>& part, bool is_to_be) {
    const std::uint64_t mask = is_to_be ? ~std::uint64_t{0} : 0;
    std::uint64_t borrow = 0;
    for (int i = first; i < N; ++i) {
        const std::uint64_t limb = i - first < M ? part.limb[i - first] & mask : 0;
        const Uint128 difference = static_cast<Uint128>(from.limb[i]) - limb - borrow;
        from.limb[i] = static_cast<std::uint64_t>(difference);
        borrow = static_cast<std::uint64_t>(difference >> 64) & 1;
    }
}

// The full product: no bit is lost. A negative factor of few limbs was taken for one that is larger
// by 2^64N, which is taken away again without a branch; of many limbs most are often zero in the
// magnitude, and skipped.
template <int N, int M>
Wide<N + M> operator*(const Wide<N>& a, const Wide<M>& b) {
    if constexpr (N == 1 && M == 1) {
        const Int128 product = static_cast<Int128>(static_cast<std::int64_t>(a.limb[0])) *
                               static_cast<std::int64_t>(b.limb[0]);
        return {static_cast<std::uint64_t>(product), static_cast<std::uint64_t>(product >> 64)};
    } else if constexpr (N + M <= 5) {
        Wide<N + M> product = unsigned_product(a, b);
        take_away(product, N, b, a.negative());
        take_away(product, M, a, b.negative());
        return product;
    } else {
        const Wide<N + M> product = unsigned_product(magnitude(a), magnitude(b));
        return a.negative() != b.negative() ? Wide<N + M>{} - product : product;
    }
}

// The sign of a b - c d, from the products of magnitudes.
inline int sign_of_difference(Int128 a, Int128 b, Int128 c, Int128 d) {
    const auto product = [](Int128 p, Int128 q) {
        const auto size = [](Int128 value) {
            const auto bits = static_cast<Uint128>(value < 0 ? -value : value);
            return Wide<2>{static_cast<std::uint64_t>(bits),
                           static_cast<std::uint64_t>(bits >> 64)};
        };
        return unsigned_product(size(p), size(q));
    };
    const bool first_is_negative = (a < 0) != (b < 0), second_is_negative = (c < 0) != (d < 0);
    const Wide<4> first = product(a, b), second = product(c, d);
    const int sign =
        first_is_negative == second_is_negative ? (first - second).sign() : (first + second).sign();
    return first_is_negative ? -sign : sign;
}

// value * 2^shift, which must fit.
template <int N>
Wide<N> shifted(std::int64_t value, int shift) {
    if constexpr (N == 1) return {static_cast<std::uint64_t>(value) << shift};
    const bool negative = value < 0;
    const std::uint64_t bits =
        negative ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
    Wide<N> result{};
    const int at = shift / 64;
    const int by = shift % 64;
    if (bits != 0) {
        result.limb[at] = bits << by;
        if (by != 0 && at + 1 < N) result.limb[at + 1] = bits >> (64 - by);
    }
    return negative ? Wide<N>{} - result : result;
}

}  // namespace liftmesh
