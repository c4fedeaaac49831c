// The places of faces in an ascending list of some of them: a bit for each face that is in it, and
// for each 64 faces the place of the first. The bits of one list are taken back in as many steps as
// it has faces.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace liftmesh {

class Places {
 public:
    explicit Places(std::size_t faces) : words_(faces / 64 + 1) {}

    // Of ascending faces, one after the other.
    void add(std::int32_t face, std::int32_t place) {
        Word& word = words_[number(face)];
        if (word.bits == 0) word.first = place;
        word.bits |= bit(face);
    }
    // The word of a face that was added, and so all faces in it.
    void remove(std::int32_t face) { words_[number(face)].bits = 0; }

    // The place of a face, or -1.
    std::int32_t find(std::int32_t face) const {
        if (face < 0) return -1;
        const Word& word = words_[number(face)];
        const std::uint64_t mine = bit(face);
        return (word.bits & mine) == 0 ? -1 : word.first + std::popcount(word.bits & (mine - 1));
    }

 private:
    struct Word {
        std::uint64_t bits = 0;
        std::int32_t first = 0;
    };
    static std::size_t number(std::int32_t face) { return static_cast<std::size_t>(face) / 64; }
    static std::uint64_t bit(std::int32_t face) { return std::uint64_t{1} << (face % 64); }

    std::vector<Word> words_;
};

}  // namespace liftmesh
