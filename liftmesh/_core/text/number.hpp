// Numbers in text, read and written as Python does.
//
// What is a number is what Python's `float` takes without underscores and without digits of other
// scripts: a sign, then digits with a point and an exponent, or inf, infinity or nan in any case.
// fast_float rounds correctly, as std::from_chars does, which not every standard library has, and
// takes three quarters of the time; but it takes no plus sign, and takes nan(...).
#pragma once

#include "base/standard.hpp"

namespace liftmesh::text {

inline bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// Reads the longest number at the beginning of [at, end), and returns where it ends; null if there
// is none.
const char* parse_number(const char* at, const char* end, double& value);

// Reads a whole number: digits, after a sign or not. False for any other word, and for the
// largest and smallest int64 and all beyond.
bool parse_whole(std::string_view word, std::int64_t& value);

// The shortest decimal number that rounds to a double.
//
// R. Giulietti, "The Schubfach way to render doubles" (2022): of the decimals in the interval that
// rounds to the double, those with the fewest digits, and of these the nearest. It takes a third of
// the time of std::to_chars.
//
// digits * 10^exponent; the digits may end in zeros.
struct Decimal {
    std::uint64_t digits;
    int exponent;
};

// Of a finite number above zero; for all others it means nothing.
Decimal shortest_decimal(double value);

// The room that a value may take while it is written, of any type: more than its text.
inline constexpr int longest_number = 48;

// These write a value and return its end.

// The shortest digits that round-trip, as Python's `repr` writes them.
char* print_shortest(char* out, double value);
char* print_shortest(char* out, float value);

// The same, given the shortest decimal of the value without its sign, if it is finite and not 0.
char* print_shortest(char* out, double value, Decimal shortest);

// Nine significant digits, as "%.9g": they round-trip in single precision even if they are read as
// a double first, which the shortest ones do not guarantee.
char* print_nine_digits(char* out, float value);

char* print_whole(char* out, std::int64_t value);
char* print_whole(char* out, std::uint64_t value);

}  // namespace liftmesh::text
