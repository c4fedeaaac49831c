// Signed integers of up to a fixed number of limbs, as sign and magnitude: only the limbs in use
// are touched, so short numbers are cheap and nothing is allocated.
#pragma once

#include <algorithm>
#include <cstdint>

#include "predicates/wide.hpp"

namespace liftmesh::apollonius {

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

    friend Integer operator*(const Integer& a, const Integer& b) {
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
    static Integer sum(const Integer& a, const Integer& b, bool b_is_negative) {
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
};

}  // namespace liftmesh::apollonius
