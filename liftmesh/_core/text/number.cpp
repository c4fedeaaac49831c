#include "text/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <system_error>

namespace liftmesh::text {

namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

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

// The exponent behind the digits of a number, at most a few times the length of any file.
std::int64_t exponent(const char* at, const char* end) {
    constexpr std::int64_t most = std::int64_t{1} << 58;
    const bool negative = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    std::int64_t value = 0;
    for (; at != end && value < most; ++at) value = 10 * value + (*at - '0');
    return negative ? -value : value;
}

// Whether a number that is out of range is too large: its first digit that is not 0 stands before
// the point. Otherwise it is too small.
bool is_large(const char* at, const char* end) {
    const char* const mantissa_end =
        std::find_if(at, end, [](char c) { return c == 'e' || c == 'E'; });
    const char* const point = std::find(at, mantissa_end, '.');
    const char* const first =
        std::find_if(at, mantissa_end, [](char c) { return c >= '1' && c <= '9'; });
    std::int64_t place = first < point ? point - first : point + 1 - first;
    if (mantissa_end != end) place += exponent(mantissa_end + 1, end);
    return place > 0;
}

const char* parse_decimal(const char* at, const char* end, double& value) {
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error == std::errc::invalid_argument) return nullptr;
    if (error == std::errc::result_out_of_range)
        value = is_large(at, stop) ? std::numeric_limits<double>::infinity() : 0.0;
    return stop;
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
    const auto [stop, error] = std::from_chars(word.data(), end, value);
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

// Digits without a point, which stands behind the first `point` of them.
char* print_fixed(char* out, std::string_view digits, std::ptrdiff_t point) {
    const auto count = static_cast<std::ptrdiff_t>(digits.size());
    if (point <= 0) return copied(filled(copied(out, "0."), -point), digits);
    if (point >= count) return copied(filled(copied(out, digits), point - count), ".0");
    const auto before = static_cast<std::size_t>(point);
    return copied(copied(copied(out, digits.substr(0, before)), "."), digits.substr(before));
}

// Python writes an exponent where the point would stand behind the sixteenth digit, or behind three
// zeros after "0.".
template <class Float>
char* print_finite(char* out, Float value) {
    char text[longest_number];
    const char* const end =
        std::to_chars(text, text + longest_number, value, std::chars_format::scientific).ptr;
    const char* first = text;
    if (*first == '-') *out++ = *first++;
    const char* const mark = std::find(first, end, 'e');
    const std::ptrdiff_t point = exponent(mark + 1, end) + 1;
    if (point <= -4 || point > 16)
        return copied(out, {first, static_cast<std::size_t>(end - first)});
    char digits[longest_number];
    digits[0] = *first;
    const char* const rest = std::min(first + 2, mark);  // behind the point
    const char* const digits_end = std::copy(rest, mark, digits + 1);
    return print_fixed(out, {digits, static_cast<std::size_t>(digits_end - digits)}, point);
}

// Whole numbers that int64 and double hold exactly, but for -0.
bool is_whole(double value) {
    return std::abs(value) < 1e15 && value == std::trunc(value) &&
           (value != 0 || !std::signbit(value));
}

// Of other numbers from 0.001 on the shorter of the two notations, which std::to_chars writes, is
// that without an exponent: as Python's.
bool has_plain_digits(double value) {
    const double magnitude = std::abs(value);
    return magnitude >= 0.001 && magnitude < 1e15;
}

}  // namespace

char* print_shortest(char* out, double value) {
    if (is_whole(value)) return copied(print_whole(out, static_cast<std::int64_t>(value)), ".0");
    if (has_plain_digits(value)) return std::to_chars(out, out + longest_number, value).ptr;
    return std::isfinite(value) ? print_finite(out, value) : print_non_finite(out, value);
}

char* print_shortest(char* out, float value) {
    return std::isfinite(value) ? print_finite(out, value) : print_non_finite(out, value);
}

char* print_nine_digits(char* out, float value) {
    const double exact = value;
    if (!std::isfinite(value)) return print_non_finite(out, exact);
    return std::to_chars(out, out + longest_number, exact, std::chars_format::general, 9).ptr;
}

char* print_whole(char* out, std::int64_t value) {
    return std::to_chars(out, out + longest_number, value).ptr;
}

char* print_whole(char* out, std::uint64_t value) {
    return std::to_chars(out, out + longest_number, value).ptr;
}

}  // namespace liftmesh::text
