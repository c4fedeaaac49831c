// Brings equal items together: a hash distributes them, first into parts that fit the cache, then
// each part into buckets. Both steps are counting sorts, stable for any number of threads.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/counting_sort.hpp"

namespace liftmesh {

// The top bits of `Hash()(item)` should depend on everything that distinguishes items.
template <class Item, class Hash>
class HashPartition {
 public:
    // The items come in several shares. Incomplete if the interrupt came first.
    HashPartition(const std::vector<std::vector<Item>>& shares, ThreadPool& pool)
        : interrupt_(pool.interrupt()) {
        std::size_t count = 0;
        for (const auto& share : shares) count += share.size();
        bits_ = std::min(static_cast<int>(std::bit_width(count / population)), most_bits);
        items_ = allocate<Item>(count);
        CountingSort sort(shares.size(), shares.size(), std::size_t{1} << bits_, pool);
        complete_ = sort.sort(
            [&](const Share& share, auto visit) {
                for (const Item& item : shares[share.number]) visit(item);
            },
            [this](const Item& item) { return digit(item, 0, bits_); },
            [this](std::size_t place, const Item& item) { items_[place] = item; });
        starts_ = std::move(sort).starts();
    }

    bool complete() const { return complete_; }
    std::size_t size() const { return starts_.empty() ? 0 : starts_.size() - 1; }

    // Calls visit(bucket) for the buckets of a part. Equal items are in one bucket.
    template <class Visit>
    void for_each_bucket(std::size_t part, Visit visit) const {
        const std::span<const Item> items(items_.get() + starts_[part],
                                          items_.get() + starts_[part + 1]);
        const int bits = std::min(static_cast<int>(std::bit_width(items.size())), most_bits);
        std::vector<Item> sorted(items.size());
        ThisThread alone{interrupt_};
        CountingSort sort(items.size(), 1, std::size_t{1} << bits, alone);
        const bool done = sort.sort(
            [items](auto, auto add) {
                for (const Item& item : items) add(item);
            },
            [this, bits](const Item& item) { return digit(item, bits_, bits); },
            [&](std::size_t place, const Item& item) { sorted[place] = item; });
        if (!done) return;
        const std::vector<std::size_t> starts = std::move(sort).starts();
        for (std::size_t i = 0; i + 1 < starts.size(); ++i)
            if (starts[i] != starts[i + 1])
                visit(std::span(sorted).subspan(starts[i], starts[i + 1] - starts[i]));
    }

 private:
    static constexpr std::size_t population = 2048;
    static constexpr int most_bits = 13;

    // `bits` bits of the hash, after its first `after`.
    static std::size_t digit(const Item& item, int after, int bits) {
        return bits == 0 ? 0 : Hash()(item) << after >> (64 - bits);
    }

    Interrupt& interrupt_;
    Buffer<Item> items_;
    std::vector<std::size_t> starts_;
    int bits_ = 0;
    bool complete_ = true;
};

}  // namespace liftmesh
