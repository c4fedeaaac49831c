// Tetrahedra under construction: one flat array, half a cache line for each.
//
// A tetrahedron t has four vertices and four facets; facet k, opposite vertex k, has the name
// 4 t + k. Its neighbour across facet k is given by the name of the same facet on the other side.
// All are positive: volume_sign() of the vertices is 1. For each facet of the hull there is a ghost
// with the vertex `ghost` at place 3, which stands for a point beyond that facet.
//
// Slots of removed tetrahedra are used again, so the array is as long as it was at most needed.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"

namespace liftmesh {

using Word = std::uint32_t;

struct Tetrahedron {
    std::array<Vertex, 4> vertex;
    std::array<Word, 4> across;

    static constexpr Vertex ghost = ~Vertex{0};

    bool is_ghost() const { return vertex[3] == ghost; }
    bool is_free() const { return vertex[0] == ghost; }
};

constexpr Word facet_name(Word tetrahedron, unsigned k) {
    return 4 * tetrahedron + k;
}

class SpaceMesh {
 public:
    static constexpr std::size_t most = std::size_t{1} << 29;  // names are below 2^31

    explicit SpaceMesh(std::size_t room)
        : room_(std::min(room, most)),
          tetrahedra_(allocate<Tetrahedron>(room_)),
          marks_(allocate<std::uint8_t>(room_)) {}

    Tetrahedron& operator[](Word t) { return tetrahedra_[t]; }
    const Tetrahedron& operator[](Word t) const { return tetrahedra_[t]; }
    std::uint8_t& mark(Word t) { return marks_[t]; }
    std::size_t slots() const { return slots_; }

    void join(Word facet, Word other) {
        tetrahedra_[facet / 4].across[facet % 4] = other;
        tetrahedra_[other / 4].across[other % 4] = facet;
    }

    // A slot, whose mark is 0.
    Word take() {
        if (!free_.empty()) {
            const Word t = free_.back();
            free_.pop_back();
            return t;
        }
        if (slots_ == room_) grow();
        marks_[slots_] = 0;
        return static_cast<Word>(slots_++);
    }
    void release(Word t) { free_.push_back(t); }

    // Ends the use of the mesh: hands over all slots, of which those that are free begin with a
    // ghost.
    Buffer<Tetrahedron> finish() {
        for (Word t : free_) tetrahedra_[t].vertex[0] = Tetrahedron::ghost;
        free_ = {};
        marks_.reset();
        return std::move(tetrahedra_);
    }

 private:
    void grow() {
        if (room_ >= most) throw std::bad_alloc();  // GCOV_EXCL_LINE: of 17 GB
        room_ = std::min(room_ + room_ / 2 + 64, most);
        tetrahedra_ = enlarged(std::move(tetrahedra_), room_);
        marks_ = enlarged(std::move(marks_), room_);
    }

    std::size_t room_, slots_ = 0;
    Buffer<Tetrahedron> tetrahedra_;
    Buffer<std::uint8_t> marks_;
    std::vector<Word> free_;
};

}  // namespace liftmesh
