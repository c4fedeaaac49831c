// Numbers of the corners of all pieces of an overlay: vertices of the first surface, then of the
// second, then crossings in the order of their pieces. A vertex belongs to the piece of the least
// faces that have it, and a crossing to that of the earlier of both faces at each side.
#pragma once

#include "parallel/blocks.hpp"
#include "surface/pieces.hpp"

namespace liftmesh {

inline constexpr std::size_t most_numbers = 0x7fffffff;
inline constexpr std::size_t block_of_pieces = std::size_t{1} << 13;

// The ends of a side of the first surface and one of the second, from the lesser end of each.
using SideCrossing = std::array<std::int32_t, 4>;

struct CornerNames {
    Buffer<std::int32_t> of_corners;
    std::vector<std::uint32_t> owners;                 // the pieces of vertices; `none` if unused
    std::vector<std::vector<SideCrossing>> crossings;  // of each block of pieces
    std::vector<std::size_t> before;                   // the names before each block, and of all

    std::size_t count() const { return before.back(); }
};

// Calls work(piece, block) for all pieces, as `hold_in_blocks` does.
template <class Work>
bool hold_in_pieces(const Pieces& pieces, ThreadPool& pool, bool& holds, Work work) {
    return hold_in_blocks(
        pieces.count, block_of_pieces, pool, holds,
        [&](std::size_t i, std::size_t block) { return work(pieces.pieces[i], block); });
}

// False if the interrupt came first, or the pieces contradict each other, or are too many: then
// they are not sound.
bool name_corners(const std::array<LocalSurface, 2>& surfaces, const Pieces& pieces,
                  CornerNames& names, ThreadPool& pool, bool& is_sound);

}  // namespace liftmesh
