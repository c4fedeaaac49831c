// A stable sort by small integers, in linear time on every input. The items come in shares, one
// after the other, each a task for any thread. A first pass counts the keys of each share; then it
// is known where the items of each key and share go, and a second pass stores them there. The
// shares of a key stand in order, so the result is the same for any number of them.
#pragma once

#include "base/status.hpp"

namespace liftmesh {

// In place of a thread pool, for a sort within a task.
struct ThisThread {
    Interrupt& interrupt;

    template <class Work>
    bool run(std::size_t tasks, Work work) {
        for (std::size_t task = 0; task < tasks; ++task) work(task);
        return !interrupt.requested();
    }
};

// A share of the items, and its number.
struct Share {
    std::size_t first, last, number;
};

// A share for each thread, as far as there is work, but few: each has a number for every key.
inline std::size_t few_shares(std::size_t parts, std::size_t threads) {
    constexpr std::size_t most = 4;
    return std::clamp<std::size_t>(std::min(parts, threads), 1, most);
}

template <class Pool>
class CountingSort {
 public:
    CountingSort(std::size_t items, std::size_t shares, std::size_t keys, Pool& pool)
        : items_(items), keys_(keys), pool_(pool), next_(shares) {}

    // Calls work(share, population), which adds 1 to population[key] for each item of the share.
    // False if the interrupt came first.
    template <class Work>
    bool count(Work work) {
        const bool done = pool_.run(next_.size(), [this, &work](std::size_t i) {
            next_[i].assign(keys_, 0);
            work(share(i), next_[i].data());
        });
        if (done) find_places();
        return done;
    }

    // Hands over where each key starts, and the end of the last.
    std::vector<std::size_t> starts() && { return std::move(starts_); }

    // Calls work(share, next), which stores each item of the share, in order, at next[key]++.
    template <class Work>
    bool move(Work work) {
        return pool_.run(next_.size(),
                         [this, &work](std::size_t i) { work(share(i), next_[i].data()); });
    }

    // Both passes: visit_items(share, visit) visits the items of a share, and store(place, item)
    // stores one.
    template <class VisitItems, class Key, class Store>
    bool sort(VisitItems visit_items, Key key, Store store) {
        return count([&](const Share& share, std::uint32_t* population) {
                   visit_items(share, [&](const auto& item) { ++population[key(item)]; });
               }) &&
               move([&](const Share& share, std::uint32_t* next) {
                   visit_items(share, [&](const auto& item) { store(next[key(item)]++, item); });
               });
    }

 private:
    Share share(std::size_t i) const {
        return {items_ * i / next_.size(), items_ * (i + 1) / next_.size(), i};
    }

    void find_places() {
        starts_.resize(keys_ + 1);
        std::uint32_t place = 0;
        for (std::size_t key = 0; key < keys_; ++key) {
            starts_[key] = place;
            for (std::vector<std::uint32_t>& next : next_) place += std::exchange(next[key], place);
        }
        starts_[keys_] = place;
    }

    std::size_t items_, keys_;
    Pool& pool_;
    std::vector<std::vector<std::uint32_t>> next_;  // of each share and key
    std::vector<std::size_t> starts_;
};

}  // namespace liftmesh
