// E_L: the edges of which one facet is known, each with its place in that facet.
//
// A hash table with linear probing; removing an edge closes the gap, so that the table holds only
// the front of the wrapping, which fits the cache.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/hash.hpp"
#include "base/point.hpp"

namespace liftmesh::paper {

class OpenEdges {
 public:
    struct Place {
        std::uint32_t facet;
        unsigned k;
    };

    void put(Vertex tail, Vertex head, Place place) {
        if (2 * ++count_ > entries_.size()) grow();
        insert({key(tail, head), place});
    }

    std::optional<Place> take(Vertex tail, Vertex head) {
        const std::uint64_t wanted = key(tail, head);
        for (std::size_t at = home(wanted); entries_[at].key != empty; at = next(at)) {
            if (entries_[at].key != wanted) continue;
            const Place place = entries_[at].place;
            close_gap(at);
            --count_;
            return place;
        }
        return std::nullopt;
    }

 private:
    static constexpr std::uint64_t empty = ~std::uint64_t{0};  // no edge joins a vertex to itself
    struct Entry {
        std::uint64_t key = empty;
        Place place{};
    };

    static std::uint64_t key(Vertex tail, Vertex head) {
        return static_cast<std::uint64_t>(tail) << 32 | head;
    }
    std::size_t home(std::uint64_t key) const {
        return static_cast<std::size_t>(hash(key) >> shift_);
    }
    std::size_t next(std::size_t at) const { return (at + 1) & (entries_.size() - 1); }

    void insert(const Entry& entry) {
        std::size_t at = home(entry.key);
        while (entries_[at].key != empty) at = next(at);
        entries_[at] = entry;
    }

    // Entries that were pushed past the gap move back into it.
    void close_gap(std::size_t gap) {
        const std::size_t mask = entries_.size() - 1;
        for (std::size_t at = next(gap); entries_[at].key != empty; at = next(at)) {
            if (((at - home(entries_[at].key)) & mask) < ((at - gap) & mask)) continue;
            entries_[gap] = entries_[at];
            gap = at;
        }
        entries_[gap].key = empty;
    }

    void grow() {
        std::vector<Entry> old(2 * entries_.size());
        old.swap(entries_);
        --shift_;
        for (const Entry& entry : old)
            if (entry.key != empty) insert(entry);
    }

    std::vector<Entry> entries_{std::vector<Entry>(std::size_t{1} << 10)};
    int shift_ = 64 - 10;
    std::size_t count_ = 0;
};

}  // namespace liftmesh::paper
