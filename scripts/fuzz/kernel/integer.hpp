// Integers of any length, as one learns to calculate at school: a sign, and digits of 32 bits.
//
// They share nothing with the kernel's, which are of fixed length and in two's complement. They are
// for judging it: slow, short and plain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fuzzing {

class Integer {
 public:
    Integer() = default;
    // mantissa * 2^shift
    Integer(std::int64_t mantissa, unsigned shift) : negative_(mantissa < 0) {
        const auto bits = static_cast<std::uint64_t>(mantissa);
        const std::uint64_t magnitude = negative_ ? 0 - bits : bits;
        digits_.assign(shift / 32 + 3, 0);
        for (unsigned i = 0; i < 64; ++i)
            if (magnitude >> i & 1) digits_[(i + shift) / 32] |= 1u << (i + shift) % 32;
        trim();
    }

    int sign() const { return digits_.empty() ? 0 : negative_ ? -1 : 1; }

    Integer operator-() const {
        Integer result = *this;
        result.negative_ = !negative_;
        return result;
    }
    friend Integer operator+(const Integer& a, const Integer& b) {
        if (a.negative_ == b.negative_) return signed_as(a, sum(a.digits_, b.digits_));
        return less(a.digits_, b.digits_) ? signed_as(b, difference(b.digits_, a.digits_))
                                          : signed_as(a, difference(a.digits_, b.digits_));
    }
    friend Integer operator-(const Integer& a, const Integer& b) { return a + -b; }
    friend Integer operator*(const Integer& a, const Integer& b) {
        Integer result;
        result.negative_ = a.negative_ != b.negative_;
        result.digits_.assign(a.digits_.size() + b.digits_.size(), 0);
        for (std::size_t i = 0; i < a.digits_.size(); ++i) {
            std::uint64_t carry = 0;
            for (std::size_t j = 0; j < b.digits_.size(); ++j) {
                carry += std::uint64_t{a.digits_[i]} * b.digits_[j] + result.digits_[i + j];
                result.digits_[i + j] = static_cast<std::uint32_t>(carry);
                carry >>= 32;
            }
            result.digits_[i + b.digits_.size()] = static_cast<std::uint32_t>(carry);
        }
        result.trim();
        return result;
    }

 private:
    using Digits = std::vector<std::uint32_t>;  // lowest first; none is zero at the end

    static Integer signed_as(const Integer& model, Digits digits) {
        Integer result;
        result.negative_ = model.negative_;
        result.digits_ = std::move(digits);
        result.trim();
        return result;
    }
    static bool less(const Digits& a, const Digits& b) {
        if (a.size() != b.size()) return a.size() < b.size();
        for (std::size_t i = a.size(); i-- > 0;)
            if (a[i] != b[i]) return a[i] < b[i];
        return false;
    }
    static Digits sum(const Digits& a, const Digits& b) {
        if (a.size() < b.size()) return sum(b, a);
        Digits result(a.size() + 1);
        std::uint64_t carry = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            carry += std::uint64_t{a[i]} + (i < b.size() ? b[i] : 0);
            result[i] = static_cast<std::uint32_t>(carry);
            carry >>= 32;
        }
        result.back() = static_cast<std::uint32_t>(carry);
        return result;
    }
    // Of a and a smaller b.
    static Digits difference(const Digits& a, const Digits& b) {
        Digits result(a.size());
        std::int64_t borrow = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            std::int64_t digit = std::int64_t{a[i]} - (i < b.size() ? b[i] : 0) - borrow;
            borrow = digit < 0;
            digit += borrow << 32;
            result[i] = static_cast<std::uint32_t>(digit);
        }
        return result;
    }
    void trim() {
        while (!digits_.empty() && digits_.back() == 0) digits_.pop_back();
    }

    Digits digits_;
    bool negative_ = false;
};

}  // namespace fuzzing
