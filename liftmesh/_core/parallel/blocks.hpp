// A long loop that can be interrupted between blocks.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/status.hpp"

namespace liftmesh {

// Calls visit(i) for every i below count. False if the interrupt ended it early.
template <class Visit>
bool for_each_in_blocks(std::size_t count, Interrupt& interrupt, Visit visit) {
    constexpr std::size_t length = std::size_t{1} << 14;
    for (std::size_t start = 0; start < count; start += length) {
        if (start != 0 && interrupt.requested()) return false;
        const std::size_t end = std::min(start + length, count);
        for (std::size_t i = start; i < end; ++i) visit(i);
    }
    return true;
}

}  // namespace liftmesh
