// Points known to within an error, which may be enough to round their coordinates correctly.
#pragma once

#include <limits>

#include "base/double_word.hpp"

namespace liftmesh {

inline constexpr double unknown = std::numeric_limits<double>::infinity();

struct Estimate {
    DoubleWord<Pair> centre;
    Pair error;
};

// Whether every number within the error rounds to the same double. The error is widened by more
// than the rounding of the sums below.
inline bool is_certain(const Estimate& found) {
    const Pair reach = found.error + 0x1p-50 * magnitudes(found.centre.low);
    const PairBits certain = (found.centre.high + (found.centre.low + reach) == found.centre.high) &
                             (found.centre.high + (found.centre.low - reach) == found.centre.high);
    return (certain[0] & certain[1]) != 0;
}

}  // namespace liftmesh
