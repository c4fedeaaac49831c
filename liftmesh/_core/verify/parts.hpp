// What may belong together is brought together: things are dealt out by a hash, first into parts
// that fit the cache, then, part by part, into handfuls. Counting sorts, stable for whatever
// threads.
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

namespace liftmesh {

// `Hash` says by `operator()(item)` what is dealt out by; the top bits should depend on all that
// tells items apart.
template <class Item, class Hash>
class Parts {
 public:
    // Of items that come in several shares. Not whole where the interrupt came first.
    Parts(const std::vector<std::vector<Item>>& shares, ThreadPool& pool) {
        std::size_t count = 0;
        for (const auto& share : shares) count += share.size();
        bits_ = std::min(static_cast<int>(std::bit_width(count / population)), most_bits);
        std::vector<std::vector<std::uint32_t>> next(shares.size());
        whole_ = pool.run(shares.size(), [&](std::size_t i) {
            next[i].assign(std::size_t{1} << bits_, 0);
            for (const Item& item : shares[i]) ++next[i][digit(item, 0, bits_)];
        });
        if (!whole_) return;
        find_places(next);
        items_ = allocate<Item>(count);
        whole_ = pool.run(shares.size(), [&](std::size_t i) {
            for (const Item& item : shares[i]) items_[next[i][digit(item, 0, bits_)]++] = item;
        });
    }

    bool whole() const { return whole_; }
    std::size_t size() const { return starts_.empty() ? 0 : starts_.size() - 1; }

    // Calls visit(handful) for all items of a part. Equal items are in one handful.
    template <class Visit>
    void for_each_handful(std::size_t part, Visit visit) const {
        const std::span<const Item> items(items_.get() + starts_[part],
                                          items_.get() + starts_[part + 1]);
        const int bits = std::min(static_cast<int>(std::bit_width(items.size())), most_bits);
        std::vector<std::uint32_t> end(std::size_t{1} << bits);
        for (const Item& item : items) ++end[digit(item, bits_, bits)];
        std::uint32_t at = 0;
        for (std::uint32_t& count : end) at += std::exchange(count, at);
        std::vector<Item> dealt(items.size());
        for (const Item& item : items) dealt[end[digit(item, bits_, bits)]++] = item;
        std::size_t first = 0;
        for (const std::uint32_t last : end)
            if (const std::size_t from = std::exchange(first, last); from != last)
                visit(std::span(dealt).subspan(from, last - from));
    }

 private:
    static constexpr std::size_t population = 2048;
    static constexpr int most_bits = 13;

    // So many bits of the hash, after those that come first.
    static std::size_t digit(const Item& item, int after, int bits) {
        return bits == 0 ? 0 : Hash()(item) << after >> (64 - bits);
    }

    void find_places(std::vector<std::vector<std::uint32_t>>& next) {
        std::uint32_t at = 0;
        for (std::size_t part = 0; part < std::size_t{1} << bits_; ++part) {
            starts_.push_back(at);
            for (auto& share : next) at += std::exchange(share[part], at);
        }
        starts_.push_back(at);
    }

    Buffer<Item> items_;
    std::vector<std::size_t> starts_;
    int bits_ = 0;
    bool whole_ = true;
};

}  // namespace liftmesh
