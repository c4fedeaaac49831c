// Lists of items that blocks of faces make at once: counted first, then filled.
//
// Other threads may write the caller's rows between the two readings. So each block keeps to the
// slots that it has counted, whatever it finds the second time, and slots that stay empty hold an
// item that stands for none.
#pragma once

#include "base/buffer.hpp"

namespace liftmesh {

template <class Item>
class Lists {
 public:
    Lists(std::size_t lists, std::size_t blocks) : blocks_(blocks), start_(lists * blocks + 1) {}

    std::size_t blocks() const { return blocks_; }
    void count(std::size_t list, std::size_t block) { ++start_[slot(list, block) + 1]; }

    // After everything is counted.
    void make_room() {
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        next_.assign(start_.begin(), start_.end() - 1);
        items_ = allocate<Item>(start_.back());
    }
    void put(std::size_t list, std::size_t block, const Item& item) {
        const std::size_t at = slot(list, block);
        if (next_[at] < start_[at + 1]) items_[next_[at]++] = item;
    }
    // After everything is put.
    void close(const Item& none) {
        for (std::size_t at = 0; at < next_.size(); ++at)
            for (; next_[at] < start_[at + 1]; ++next_[at]) items_[next_[at]] = none;
        next_ = {};
    }

    const Item* begin(std::size_t list) const { return &items_[start_[slot(list, 0)]]; }
    const Item* end(std::size_t list) const { return &items_[start_[slot(list + 1, 0)]]; }

 private:
    std::size_t slot(std::size_t list, std::size_t block) const { return list * blocks_ + block; }

    std::size_t blocks_;
    std::vector<std::size_t> start_, next_;  // by list and block
    Buffer<Item> items_;
};

using FaceLists = Lists<std::int32_t>;  // -1 for none

}  // namespace liftmesh
