// Long loops in blocks: between these they can be interrupted, or each is a task for any thread.
#pragma once

#include "base/status.hpp"
#include "parallel/thread_pool.hpp"

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

inline std::size_t blocks(std::size_t count, std::size_t length) {
    return (count + length - 1) / length;
}

// Calls work(first, last, block) for the blocks of so many items, each on any thread. False if the
// interrupt came first.
template <class Work>
bool in_blocks(std::size_t count, std::size_t length, ThreadPool& pool, Work work) {
    if (count <= length) {
        if (count > 0) work(std::size_t{0}, count, std::size_t{0});
        return !pool.interrupt().requested();
    }
    return pool.run(blocks(count, length), [&, count, length](std::size_t at) {
        work(at * length, std::min(count, (at + 1) * length), at);
    });
}

// Calls work(i, block) for all below `count`; the rest of a block is left out where it is false.
// False if it was, which clears `holds`, or if the interrupt came first.
template <class Work>
bool hold_in_blocks(std::size_t count, std::size_t length, ThreadPool& pool, bool& holds,
                    Work work) {
    std::atomic<bool> all = true;
    const auto until = [&](std::size_t i, std::size_t last, std::size_t block) {
        while (i < last && work(i, block)) ++i;
        if (i < last) all = false;
    };
    const bool done = in_blocks(count, length, pool, until);
    if (!all) holds = false;
    return done && all;
}

// The numbers that a condition holds for, in order: blocks are counted, and then each block writes
// from the place where it begins.

// Fills `found` with every number below `count` for which holds(number). False if interrupted.
template <class Number, class Holds>
bool select(std::size_t count, ThreadPool& pool, Holds holds, std::vector<Number>& found) {
    constexpr std::size_t length = std::size_t{1} << 15;
    std::vector<std::size_t> place(blocks(count, length) + 1);
    const auto add_up = [&](std::size_t i, std::size_t last, std::size_t task) {
        for (; i < last; ++i) place[task + 1] += holds(i);
    };
    if (!in_blocks(count, length, pool, add_up)) return false;
    std::partial_sum(place.begin(), place.end(), place.begin());
    found.resize(place.back());
    return in_blocks(count, length, pool, [&](std::size_t i, std::size_t last, std::size_t task) {
        Number* to = found.data() + place[task];
        for (; i < last; ++i)
            if (holds(i)) *to++ = static_cast<Number>(i);
    });
}

}  // namespace liftmesh
