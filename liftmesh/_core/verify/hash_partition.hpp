// Brings equal items together: a hash distributes them, first into parts that fit the cache, then
// each part into buckets. Both steps are counting sorts, stable for any number of threads.
#pragma once

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

// Which items may have an equal: a hash sends each to one of many slots, and an item that is alone
// in its slot has none. Two bits for each slot: whether an item fell into it, and whether a second
// one did.

class Slots {
 public:
    explicit Slots(std::size_t items)
        : bits_(static_cast<int>(std::bit_width(per_item * items / per_word))),
          words_(std::size_t{1} << bits_) {}

    // Safe for several threads.
    void add(std::uint64_t hash) {
        const platform::Shared shared(*word(hash));
        const std::uint64_t one = std::uint64_t{1} << place(hash);
        const std::uint64_t before = shared.fetch_or(one);
        if (before & one) shared.fetch_or(one << 1);
    }

    bool is_shared(std::uint64_t hash) { return *word(hash) >> place(hash) & 2; }

    // Calls visit(i, hash_of(i)) from `first` on to `last`. The words are prefetched.
    template <class HashOf, class Visit>
    void for_each(std::size_t first, std::size_t last, HashOf hash_of, Visit visit) {
        constexpr std::size_t abreast = 64;
        for (; first < last; first += abreast) {
            const std::size_t end = std::min(last, first + abreast);
            std::uint64_t hashes[abreast];
            for (std::size_t i = first; i < end; ++i)
                __builtin_prefetch(word(hashes[i - first] = hash_of(i)), 1);
            for (std::size_t i = first; i < end; ++i) visit(i, hashes[i - first]);
        }
    }

 private:
    static constexpr std::size_t per_item = 16, per_word = 32;

    std::uint64_t* word(std::uint64_t hash) {
        return &words_[bits_ == 0 ? 0 : hash >> (64 - bits_)];
    }
    int place(std::uint64_t hash) const { return static_cast<int>(hash >> (59 - bits_) & 31) * 2; }

    int bits_;
    std::vector<std::uint64_t> words_;
};

// Keeps the items, in several shares, that may have an equal; calls alone(share, item) for the
// others. False if the interrupt came first.
template <class Item, class HashOf, class Alone>
bool keep_shared(std::vector<std::vector<Item>>& shares, ThreadPool& pool, HashOf hash_of,
                 Alone alone) {
    std::size_t count = 0;
    for (const auto& share : shares) count += share.size();
    Slots slots(count);
    const auto for_each = [&](std::vector<Item>& share, auto visit) {
        slots.for_each(0, share.size(), [&](std::size_t i) { return hash_of(share[i]); }, visit);
    };
    const bool added = pool.run(shares.size(), [&](std::size_t task) {
        for_each(shares[task], [&](auto, std::uint64_t hash) { slots.add(hash); });
    });
    return added && pool.run(shares.size(), [&](std::size_t task) {
        std::vector<Item>& share = shares[task];
        std::size_t kept = 0;
        for_each(share, [&](std::size_t i, std::uint64_t hash) {
            if (slots.is_shared(hash)) {
                share[kept++] = share[i];
            } else {
                alone(task, share[i]);
            }
        });
        share.erase(share.begin() + static_cast<std::ptrdiff_t>(kept), share.end());
    });
}

}  // namespace liftmesh
