// The shortest decimal number that rounds to a double.
//
// R. Giulietti, "The Schubfach way to render doubles" (2022): of the decimals in the interval that
// rounds to the double, those with the fewest digits, and of these the nearest. It takes a third of
// the time of std::to_chars.
#pragma once

#include <cstdint>

namespace liftmesh::text {

// digits * 10^exponent; the digits may end in zeros.
struct Decimal {
    std::uint64_t digits;
    int exponent;
};

// Of a finite number above zero; for all others it means nothing.
Decimal shortest_decimal(double value);

}  // namespace liftmesh::text
