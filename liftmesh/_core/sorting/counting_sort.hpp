// A stable sort by small integers, in linear time on every input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/status.hpp"
#include "parallel/blocks.hpp"

namespace liftmesh {

// Sorts by key(item), which is less than `keys`. False if the interrupt came first.
template <class Key>
bool counting_sort(std::vector<std::uint32_t>& items, std::size_t keys, Interrupt& interrupt,
                   Key key) {
    std::vector<std::uint32_t> place(keys + 1), sorted(items.size());
    const auto count = [&](std::size_t i) { ++place[key(items[i]) + 1]; };
    if (!for_each_in_blocks(items.size(), interrupt, count)) return false;
    std::partial_sum(place.begin(), place.end(), place.begin());
    const auto move = [&](std::size_t i) { sorted[place[key(items[i])]++] = items[i]; };
    if (!for_each_in_blocks(items.size(), interrupt, move)) return false;
    items.swap(sorted);
    return true;
}

}  // namespace liftmesh
