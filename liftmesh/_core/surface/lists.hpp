// Lists of faces that blocks of faces make at once: counted first, then filled.
//
// Other threads may write the caller's rows between the two readings. So each block keeps to the
// slots that it has counted, whatever it finds the second time, and slots that stay empty hold -1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/buffer.hpp"

namespace liftmesh {

class FaceLists {
 public:
    FaceLists(std::size_t lists, std::size_t blocks)
        : blocks_(blocks), start_(lists * blocks + 1) {}

    std::size_t blocks() const { return blocks_; }
    void count(std::size_t list, std::size_t block) { ++start_[slot(list, block) + 1]; }

    // After everything is counted.
    void make_room() {
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        next_.assign(start_.begin(), start_.end() - 1);
        faces_ = allocate<std::int32_t>(start_.back());
    }
    void put(std::size_t list, std::size_t block, std::int32_t face) {
        const std::size_t at = slot(list, block);
        if (next_[at] < start_[at + 1]) faces_[next_[at]++] = face;
    }
    // After everything is put.
    void close() {
        for (std::size_t at = 0; at < next_.size(); ++at)
            for (; next_[at] < start_[at + 1]; ++next_[at]) faces_[next_[at]] = -1;
        next_ = {};
    }

    // Faces, or -1.
    const std::int32_t* begin(std::size_t list) const { return &faces_[start_[slot(list, 0)]]; }
    const std::int32_t* end(std::size_t list) const { return &faces_[start_[slot(list + 1, 0)]]; }

 private:
    std::size_t slot(std::size_t list, std::size_t block) const { return list * blocks_ + block; }

    std::size_t blocks_;
    std::vector<std::size_t> start_, next_;  // by list and block
    Buffer<std::int32_t> faces_;
};

}  // namespace liftmesh
