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
    HashPartition(const std::vector<std::vector<Item>>& shares, ThreadPool& pool) {
        std::size_t count = 0;
        for (const auto& share : shares) count += share.size();
        bits_ = std::min(static_cast<int>(std::bit_width(count / population)), most_bits);
        std::vector<std::vector<std::uint32_t>> next(shares.size());
        complete_ = pool.run(shares.size(), [&](std::size_t i) {
            next[i].assign(std::size_t{1} << bits_, 0);
            for (const Item& item : shares[i]) ++next[i][digit(item, 0, bits_)];
        });
        if (!complete_) return;
        starts_ = find_places(next, std::size_t{1} << bits_);
        items_ = allocate<Item>(count);
        complete_ = pool.run(shares.size(), [&](std::size_t i) {
            for (const Item& item : shares[i]) items_[next[i][digit(item, 0, bits_)]++] = item;
        });
    }

    bool complete() const { return complete_; }
    std::size_t size() const { return starts_.empty() ? 0 : starts_.size() - 1; }

    // Calls visit(bucket) for the buckets of a part. Equal items are in one bucket.
    template <class Visit>
    void for_each_bucket(std::size_t part, Visit visit) const {
        const std::span<const Item> items(items_.get() + starts_[part],
                                          items_.get() + starts_[part + 1]);
        const int bits = std::min(static_cast<int>(std::bit_width(items.size())), most_bits);
        std::vector<std::uint32_t> end(std::size_t{1} << bits);
        for (const Item& item : items) ++end[digit(item, bits_, bits)];
        std::uint32_t at = 0;
        for (std::uint32_t& count : end) at += std::exchange(count, at);
        std::vector<Item> sorted(items.size());
        for (const Item& item : items) sorted[end[digit(item, bits_, bits)]++] = item;
        std::size_t first = 0;
        for (const std::uint32_t last : end)
            if (const std::size_t from = std::exchange(first, last); from != last)
                visit(std::span(sorted).subspan(from, last - from));
    }

 private:
    static constexpr std::size_t population = 2048;
    static constexpr int most_bits = 13;

    // `bits` bits of the hash, after its first `after`.
    static std::size_t digit(const Item& item, int after, int bits) {
        return bits == 0 ? 0 : Hash()(item) << after >> (64 - bits);
    }

    Buffer<Item> items_;
    std::vector<std::size_t> starts_;
    int bits_ = 0;
    bool complete_ = true;
};

}  // namespace liftmesh
