#include "text/number.hpp"

#include <charconv>

#include "third_party/fast_float.h"

namespace liftmesh::text {

namespace {

// Whether [at, end) begins with a word, given in lower case.
bool begins_with(const char* at, const char* end, std::string_view word) {
    if (static_cast<std::size_t>(end - at) < word.size()) return false;
    return std::equal(word.begin(), word.end(), at,
                      [](char wanted, char found) { return wanted == (found | 0x20); });
}

const char* parse_named(const char* at, const char* end, double& value) {
    for (const std::string_view word : {"infinity", "inf", "nan"}) {
        if (!begins_with(at, end, word)) continue;
        value = word == "nan" ? std::numeric_limits<double>::quiet_NaN()
                              : std::numeric_limits<double>::infinity();
        return at + word.size();
    }
    return nullptr;
}

// What is out of range becomes infinity or 0.
const char* parse_decimal(const char* at, const char* end, double& value) {
    const auto [stop, error] = fast_float::from_chars(at, end, value);
    return error == std::errc::invalid_argument ? nullptr : stop;
}

}  // namespace

const char* parse_number(const char* at, const char* end, double& value) {
    const bool negative = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    if (at == end) return nullptr;
    const bool decimal = is_digit(*at) || *at == '.';
    const char* const stop = (decimal ? parse_decimal : parse_named)(at, end, value);
    if (negative) value = -value;
    return stop;
}

bool parse_whole(std::string_view word, std::int64_t& value) {
    const char* const end = word.data() + word.size();
    const bool plus = word.size() > 1 && word[0] == '+' && is_digit(word[1]);
    const auto [stop, error] = std::from_chars(word.data() + (plus ? 1 : 0), end, value);
    return error == std::errc() && stop == end &&
           value != std::numeric_limits<std::int64_t>::max() &&
           value != std::numeric_limits<std::int64_t>::min();
}

namespace {

char* copied(char* out, std::string_view text) {
    std::memcpy(out, text.data(), text.size());
    return out + text.size();
}

char* filled(char* out, std::ptrdiff_t count) {
    std::memset(out, '0', static_cast<std::size_t>(count));
    return out + count;
}

char* print_non_finite(char* out, double value) {
    if (std::isnan(value)) return copied(out, "nan");
    return copied(out, value < 0 ? "-inf" : "inf");
}

// Text of sixteen characters in two registers, the first in the least byte: text that was just
// stored in pieces is slow to load as a whole.
struct Characters {
    std::uint64_t early, late;
};

void store(char* out, std::uint64_t text) {
    if constexpr (std::endian::native == std::endian::little)
        std::memcpy(out, &text, sizeof text);
    else
        for (std::size_t k = 0; k < sizeof text; ++k, text >>= 8) out[k] = static_cast<char>(text);
}

void store(char* out, Characters text) {
    store(out, text.early);
    store(out + 8, text.late);
}

// The digits of a number, without zeros at the end, and behind how many of them the point stands.
struct Digits {
    char first;
    Characters rest;
    std::ptrdiff_t count, point;
};

// All are written, and more behind them.
char* print_all(char* out, const Digits& digits) {
    *out = digits.first;
    store(out + 1, digits.rest);
    return out + digits.count;
}

// With the point amid the digits. It stands behind one, two or three most often, at random: so it
// is put among the first eight without a branch.
char* print_around_point(char* out, const Digits& digits) {
    const auto [early, late] = digits.rest;
    *out = digits.first;
    if (digits.point > 8) {
        store(out + 1, digits.rest);
        out[digits.point] = '.';
        store(out + digits.point + 1, late >> (8 * (digits.point - 9)));
    } else {
        const auto bits = static_cast<unsigned>(8 * (digits.point - 1));
        const std::uint64_t before = (std::uint64_t{1} << bits) - 1;
        store(out + 1, (early & before) | std::uint64_t{'.'} << bits | (early & ~before) << 8);
        store(out + 9, early >> 56 | late << 8);
        out[17] = static_cast<char>(late >> 56);
    }
    return out + digits.count + 1;
}

// Python writes an exponent where the point would stand behind the sixteenth digit, or behind four
// zeros after "0.".
char* print_exponent(char* out, std::ptrdiff_t exponent) {
    out = copied(out, exponent < 0 ? "e-" : "e+");
    exponent = std::abs(exponent);
    if (exponent < 10) *out++ = '0';
    return std::to_chars(out, out + 3, exponent).ptr;
}

char* print_digits(char* out, const Digits& digits) {
    const std::ptrdiff_t count = digits.count, point = digits.point;
    if (point > 0 && point < count) return print_around_point(out, digits);
    if (point > -4 && point <= 0) {
        std::memcpy(out, "0.000", 5);
        return print_all(out + 2 - point, digits);
    }
    if (point > 0 && point <= 16)
        return copied(filled(print_all(out, digits), point - count), ".0");
    *out++ = digits.first;
    if (count > 1) {
        *out = '.';
        store(out + 1, digits.rest);
        out += count;
    }
    return print_exponent(out, point - 1);
}

// The digits of a number below 10^8, each halving in all parts at once: 4 and 4, 2 and 2, 1 and 1.
// n / 100 is n * 5243 / 2^19 up to 9999, and n / 10 is n * 103 / 2^10 up to 99.
std::uint64_t eight_digits(std::uint64_t value) {
    const std::uint64_t fours = value / 10000 | value % 10000 << 32;
    const std::uint64_t hundreds = fours * 5243 >> 19 & 0x0000007F'0000007F;
    const std::uint64_t twos = hundreds | (fours - 100 * hundreds) << 16;
    const std::uint64_t tens = twos * 103 >> 10 & 0x000F000F'000F000F;
    return tens | (twos - 10 * tens) << 8;
}

constexpr std::uint64_t characters = 0x30303030'30303030;

// All seventeen digits that a double may have; those at the end that are 0 do not count.
Digits digits_of(Decimal decimal) {
    constexpr std::uint64_t eight = 100'000'000, fifteen = eight * 10'000'000;
    constexpr int most_digits = 17;
    while (decimal.digits < fifteen) {  // of subnormal numbers
        decimal.digits *= 10;
        --decimal.exponent;
    }
    // Sixteen or seventeen digits are equally likely: no branch is guessed.
    const bool is_sixteen = decimal.digits < 10 * fifteen;
    const std::uint64_t digits = decimal.digits * (1 + std::uint64_t{9} * is_sixteen);
    const std::uint64_t upper = digits / eight;
    const std::uint64_t high = eight_digits(upper % eight), low = eight_digits(digits % eight);
    const int zeros = low != 0 ? std::countl_zero(low) / 8 : 8 + std::countl_zero(high) / 8;
    return {static_cast<char>('0' + upper / eight),
            {high | characters, low | characters},
            most_digits - zeros,
            most_digits + decimal.exponent - is_sixteen};
}

// From what std::to_chars writes with an exponent.
Digits digits_of(float value) {
    char text[longest_number];
    const char* const end =
        std::to_chars(text, text + longest_number, value, std::chars_format::scientific).ptr;
    const char* const mark = std::find(static_cast<const char*>(text), end, 'e');
    Digits digits{text[0], {0, 0}, std::max<std::ptrdiff_t>(mark - text - 1, 1), 0};
    for (std::ptrdiff_t k = digits.count; k > 1; --k)  // nine digits at most
        digits.rest.early = digits.rest.early << 8 | static_cast<unsigned char>(text[k]);
    int exponent = 0;
    std::from_chars(mark + (mark[1] == '+' ? 2 : 1), end, exponent);
    digits.point = exponent + 1;
    return digits;
}

// Whole numbers that double holds exactly, but for -0.
bool is_whole(double value) {
    return std::abs(value) < 1e15 &&
           std::bit_cast<std::uint64_t>(value) ==
               std::bit_cast<std::uint64_t>(static_cast<double>(static_cast<std::int64_t>(value)));
}

}  // namespace

char* print_shortest(char* out, double value) {
    return print_shortest(out, value, shortest_decimal(std::abs(value)));
}

char* print_shortest(char* out, double value, Decimal shortest) {
    if (!std::isfinite(value)) return print_non_finite(out, value);
    if (is_whole(value)) return copied(print_whole(out, static_cast<std::int64_t>(value)), ".0");
    *out = '-';
    out += std::signbit(value);
    return value == 0 ? copied(out, "0.0") : print_digits(out, digits_of(shortest));
}

char* print_shortest(char* out, float value) {
    if (!std::isfinite(value)) return print_non_finite(out, value);
    if (std::signbit(value)) *out++ = '-';
    return value == 0 ? copied(out, "0.0") : print_digits(out, digits_of(std::abs(value)));
}

char* print_nine_digits(char* out, float value) {
    const double exact = value;
    if (!std::isfinite(value)) return print_non_finite(out, exact);
    return std::to_chars(out, out + longest_number, exact, std::chars_format::general, 9).ptr;
}

char* print_whole(char* out, std::int64_t value) {
    *out = '-';
    const auto bits = static_cast<std::uint64_t>(value);
    return value < 0 ? print_whole(out + 1, 0 - bits) : print_whole(out, bits);
}

char* print_whole(char* out, std::uint64_t value) {
    if (value >= 100'000'000) return std::to_chars(out, out + longest_number, value).ptr;
    const std::uint64_t digits = eight_digits(value);
    constexpr std::uint64_t last = std::uint64_t{1} << 56;  // of 0, too, one digit is shown
    const int zeros = std::countr_zero(digits | last) / 8;
    store(out, (digits | characters) >> (8 * zeros));
    return out + 8 - zeros;
}

}  // namespace liftmesh::text
