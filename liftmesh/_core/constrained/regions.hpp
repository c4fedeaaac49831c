// The regions between constraints: parts of a triangulation that no constraint separates.
#pragma once

#include "constrained/constrained.hpp"

namespace liftmesh::constrained {

// A finished triangulation with its marks.
struct Marked {
    const std::int32_t* neighbors;  // count x 3
    const std::uint8_t* marks;
    std::size_t count;

    bool is_marked(std::size_t t, unsigned k) const { return marks[t] >> k & 1; }
    std::int32_t neighbor(std::size_t t, unsigned k) const { return neighbors[3 * t + k]; }
};

// The region of each triangle, numbered in the order of their first triangles.
std::vector<std::int32_t> label(const Marked& mesh);

// What the pieces mean for carving: whether a piece bounds anything, and by how much the winding
// numbers of all outer rings and of all holes rise across it, from the right to the left of its
// direction from the first row to the second.
struct Bounds {
    std::span<const Piece> pieces;  // ascending
    const std::uint8_t* bounds;
    const std::int32_t* winding;  // two of each piece
};

enum class Carving : std::uint8_t { none, outside, holes };

// Which triangles are left. Without the outside: those that cannot be reached from beyond the hull
// except across a piece that bounds. Without holes: those around which outer rings wind more often
// than holes or, where there are no polygons, those that an odd number of such pieces separates
// from the outside, and no fewer. Regions with one of the seeds, which are triangles, are left out
// besides.
std::vector<std::uint8_t> carve(const Marked& mesh, const std::int32_t* simplices,
                                const Bounds& bounds, Carving carving,
                                std::span<const std::int32_t> seeds);

}  // namespace liftmesh::constrained
