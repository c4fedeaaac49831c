#include "text/number.hpp"

namespace liftmesh::text {

namespace {

__extension__ using Wide = unsigned __int128;

constexpr int least_power = -292, greatest_power = 324;  // of ten, for all doubles
constexpr int fraction_bits = 52;

// The floor of the logarithm of a power, for all exponents of doubles (section 8 of the paper).
constexpr int log10_of_power_of_two(int e) {
    return (e * 1262611) >> 22;
}
constexpr int log10_of_three_quarters_of_power_of_two(int e) {
    return (e * 1262611 - 524031) >> 22;
}
constexpr int log2_of_power_of_ten(int e) {
    return (e * 1741647) >> 19;
}

// The 128 leading bits of powers of ten, plus one: from above, by less than one unit.
class Powers {
 public:
    // 10^n multiplied up from 1, 10^-n divided down from a power of two: the floor of a floor is
    // the floor of the whole quotient.
    constexpr Powers() {
        Integer number{};
        number[0] = 1;
        for (int power = 0; power <= greatest_power; ++power) {
            at(power) = leading_bits(number) + 1;
            multiply_by_ten(number);
        }
        number = {};
        number.back() = 1;
        for (int power = -1; power >= least_power; --power) {
            divide_by_ten(number);
            at(power) = leading_bits(number) + 1;
        }
    }

    constexpr Wide operator[](int power) const {
        return powers_[static_cast<std::size_t>(power - least_power)];
    }

 private:
    using Integer = std::array<std::uint64_t, 20>;  // the least word first

    constexpr Wide& at(int power) { return powers_[static_cast<std::size_t>(power - least_power)]; }

    static constexpr void multiply_by_ten(Integer& number) {
        Wide carry = 0;
        for (std::uint64_t& word : number) {
            carry += Wide{word} * 10;
            word = static_cast<std::uint64_t>(carry);
            carry >>= 64;
        }
    }

    static constexpr void divide_by_ten(Integer& number) {
        Wide rest = 0;
        for (std::size_t i = number.size(); i-- > 0;) {
            rest = rest << 64 | number[i];
            number[i] = static_cast<std::uint64_t>(rest / 10);
            rest %= 10;
        }
    }

    static constexpr Wide leading_bits(const Integer& number) {
        std::size_t top = number.size() - 1;
        while (number[top] == 0) --top;
        const int shift = std::countl_zero(number[top]);
        const auto word = [&](std::size_t down) { return top < down ? 0 : number[top - down]; };
        Wide bits = Wide{word(0)} << 64 | word(1);
        if (shift != 0) bits = bits << shift | word(2) >> (64 - shift);
        return bits;
    }

    std::array<Wide, greatest_power - least_power + 1> powers_{};
};

constexpr Powers powers;

// A product of a power and a number, without its last 64 bits.
Wide product(Wide power, std::uint64_t number) {
    return (power >> 64) * number + (Wide{static_cast<std::uint64_t>(power)} * number >> 64);
}

// Without its last 128 bits, and odd if these are not all 0.
std::uint64_t rounded_to_odd(Wide product) {
    return static_cast<std::uint64_t>(product >> 64) | (static_cast<std::uint64_t>(product) > 1);
}

std::uint64_t chosen(bool first, std::uint64_t one, std::uint64_t other) {
    return other ^ ((one ^ other) & (std::uint64_t{0} - first));
}

}  // namespace

Decimal shortest_decimal(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const std::uint64_t fraction = bits & ((std::uint64_t{1} << fraction_bits) - 1);
    const int field = static_cast<int>(bits >> fraction_bits);
    const std::uint64_t c = field == 0 ? fraction : fraction | std::uint64_t{1} << fraction_bits;
    const int q = (field == 0 ? 1 : field) - 1075;
    const bool is_closer = fraction == 0 && field > 1;  // the double below than that above
    const int k = is_closer ? log10_of_three_quarters_of_power_of_two(q) : log10_of_power_of_two(q);
    const int h = q + log2_of_power_of_ten(-k) + 1;

    // The double and both ends of its interval, in quarters of 10^k. The ends belong to it if c is
    // even, since halfway a number is rounded to even.
    const Wide power = powers[-k];
    const std::uint64_t number = rounded_to_odd(product(power, (4 * c) << h));
    const std::uint64_t below =
        rounded_to_odd(product(power, (4 * c - 2 + is_closer) << h)) + (c & 1);
    const std::uint64_t above = rounded_to_odd(product(power, (4 * c + 2) << h)) - (c & 1);

    // A multiple of 10^(k+1) in the interval is shorter, and there is one at most. Which case it is
    // looks random to the processor: both are computed, and no branch is guessed.
    const std::uint64_t floor = number / 4, tens = floor / 10;
    const bool tens_down = below <= 40 * tens, tens_up = 40 * tens + 40 <= above;
    const bool down = below <= 4 * floor, up = 4 * floor + 4 <= above;
    const std::uint64_t middle = 4 * floor + 2;
    const bool nearer_up = (number > middle) | ((number == middle) & ((floor & 1) != 0));
    const std::uint64_t in_ones = floor + chosen(down != up, up, nearer_up);
    const bool shorter = (floor >= 10) & (tens_down != tens_up);
    return {chosen(shorter, 10 * (tens + tens_up), in_ones), k};
}

}  // namespace liftmesh::text
