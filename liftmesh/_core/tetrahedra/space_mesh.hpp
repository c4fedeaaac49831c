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

    // Makes room for so many more slots, as far as there are names. Moves the arrays.
    void reserve(std::size_t more) {
        if (slots_ + more <= room_) return;
        room_ = std::min(std::max(slots_ + more, room_ + room_ / 2), most);
        tetrahedra_ = enlarged(std::move(tetrahedra_), room_);
        marks_ = enlarged(std::move(marks_), room_);
    }

    // The first of so many slots one after the other, if there is room; `most` otherwise. Several
    // threads may ask at the same time.
    std::size_t take(std::size_t count) {
        std::size_t first = slots_.load();
        do {
            if (first + count > room_) return most;
        } while (!slots_.compare_exchange_weak(first, first + count));
        std::fill_n(&marks_[first], count, std::uint8_t{0});
        return first;
    }

    // Ends the use of the mesh: hands over all slots, of which those that are free begin with a
    // ghost.
    Buffer<Tetrahedron> finish(const std::vector<Word>& free) {
        for (Word t : free) tetrahedra_[t].vertex[0] = Tetrahedron::ghost;
        marks_.reset();
        return std::move(tetrahedra_);
    }

 private:
    std::size_t room_;
    std::atomic<std::size_t> slots_ = 0;
    Buffer<Tetrahedron> tetrahedra_;
    Buffer<std::uint8_t> marks_;
};

// The free slots of one thread, whose marks are 0.
class FreeSlots {
 public:
    explicit FreeSlots(SpaceMesh& mesh) : mesh_(mesh) {}

    // False if there is no room for so many.
    bool provide(std::size_t count) {
        constexpr std::size_t block = 256;
        if (free_.size() >= count) return true;
        count = std::max(count - free_.size(), block);
        std::size_t next = mesh_.take(count) + count;
        if (next > SpaceMesh::most) return false;
        while (count-- > 0) free_.push_back(static_cast<Word>(--next));
        return true;
    }
    Word take() {
        const Word t = free_.back();
        free_.pop_back();
        return t;
    }
    void release(Word t) {
        mesh_[t].vertex[0] = Tetrahedron::ghost;
        free_.push_back(t);
    }
    void add(const std::vector<Word>& others) {
        free_.insert(free_.end(), others.begin(), others.end());
    }
    const std::vector<Word>& all() const { return free_; }

 private:
    SpaceMesh& mesh_;
    std::vector<Word> free_;
};

}  // namespace liftmesh
