// A sum of numbers that are not negative, exact and rounded once: in no order of them does it have
// other bits.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "predicates/wide.hpp"

namespace liftmesh {

class Total {
 public:
    void add(double value) {
        if (!(value >= 0) || std::isinf(value)) {
            is_finite_ = false;
            return;
        }
        const auto bits = std::bit_cast<std::uint64_t>(value);
        const std::uint64_t biased = (bits >> 52) & 0x7ff, fraction = bits & (hidden - 1);
        const std::uint64_t place = biased == 0 ? 0 : biased - 1;  // 2^-1074 is in place 0
        const Uint128 shifted = static_cast<Uint128>(biased == 0 ? fraction : fraction | hidden)
                                << place % 32;
        std::uint64_t* digit = &digits_[place / 32];
        digit[0] += static_cast<std::uint32_t>(shifted);
        digit[1] += static_cast<std::uint32_t>(shifted >> 32);
        digit[2] += static_cast<std::uint32_t>(shifted >> 64);
        if (++additions_ == most_additions) carry();
    }

    // The sum times 2^exponent; NaN if a number was none, or infinite.
    double value(int exponent = 0) const {
        if (!is_finite_) return std::numeric_limits<double>::quiet_NaN();
        Total carried = *this;
        carried.carry();
        return carried.rounded(exponent);
    }

 private:
    static constexpr std::uint64_t hidden = std::uint64_t{1} << 52;
    static constexpr std::uint32_t most_additions = std::uint32_t{1} << 31;
    static constexpr int least_exponent = -1074;

    void carry() {
        std::uint64_t carried = 0;
        for (std::uint64_t& digit : digits_) {
            digit += carried;
            carried = digit >> 32;
            digit &= 0xffffffff;
        }
        additions_ = 0;
    }

    // Four digits are enough, the last of which says whether there are others.
    double rounded(int exponent) const {
        std::size_t top = digits_.size() - 1;
        while (top > 3 && digits_[top] == 0) --top;
        Uint128 lead = 0;
        for (std::size_t i = 0; i < 4; ++i) lead = lead << 32 | digits_[top - i];
        for (std::size_t i = 0; i + 3 < top; ++i) lead |= digits_[i] != 0;
        return std::ldexp(static_cast<double>(lead),
                          32 * static_cast<int>(top - 3) + least_exponent + exponent);
    }

    std::array<std::uint64_t, 68> digits_{};  // of 32 bits, and what they are to carry
    std::uint32_t additions_ = 0;
    bool is_finite_ = true;
};

}  // namespace liftmesh
