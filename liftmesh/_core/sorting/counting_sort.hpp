// Stable sorts by small integers, in linear time on every input. With several threads each counts
// the keys of a share of the items; then it is known where the items of each key and share go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
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

// Turns the number of items of each share and key into the place of the first of them: the shares
// of a key stand in order, so the sort is stable for any number of shares. Returns where each key
// starts, and the end of the last.
inline std::vector<std::size_t> find_places(std::vector<std::vector<std::uint32_t>>& shares,
                                            std::size_t keys) {
    std::vector<std::size_t> starts(keys + 1);
    std::uint32_t next = 0;
    for (std::size_t key = 0; key < keys; ++key) {
        starts[key] = next;
        for (std::vector<std::uint32_t>& share : shares) next += std::exchange(share[key], next);
    }
    starts[keys] = next;
    return starts;
}

}  // namespace liftmesh
