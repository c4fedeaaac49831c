// A node of a tiled triangulation: the points of one or more tiles, known by their frontier.
//
// The frontier is what later merges can still change: the corners of triangles that are not settled
// (territory.hpp), the points on the node's hull, and the *rim*, the directed edges that have
// finished ground on their left and none on their right. ARCHITECTURE.md proves why that is enough.
#pragma once

#include "base/buffer.hpp"
#include "base/facets.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"
#include "tiles/territory.hpp"

namespace liftmesh {

struct RimEdge {
    std::int32_t tail, head;  // records of the frontier
};

struct RowPair {
    RowId row, kept;
};

struct Node {
    Status status = Status::ok;  // collinear or too few: nothing is settled, all goes up
    std::size_t missing = 0;     // rim edges that are none: the frontiers do not fit together
    Buffer<RowId> triangles;     // triangle_count x 3, counter-clockwise from the least point
    // For each of their edges, which of these triangles is beyond it, or -1: it is of another node,
    // or nothing is there. Edge k is opposite corner k. Empty if not asked for.
    Buffer<std::int32_t> neighbors;
    std::size_t triangle_count = 0;
    std::vector<RowPair> duplicates;
    std::vector<RowId> hull;  // counter-clockwise from the least point
    std::vector<Record> frontier;
    std::vector<RimEdge> rim;
};

// Merges frontiers, given as one list of records and one of edges between them; or begins with the
// points of a tile, whose rim is empty.
Node merge_frontiers(std::span<const Record> records, std::span<const RimEdge> rim,
                     const Territory& territory, bool with_neighbors, Threads threads,
                     Interrupt& interrupt);

// Which triangles of a merge lie on ground that a child has finished.

enum class Ground : std::uint8_t { open, settled, filler };

// Marks as filler what is on the left of the rim, up to the rim. Returns how many edges of the rim
// are edges of no triangle: none, if the rim is that of the points.
std::size_t mark_filler(const Result& mesh, std::size_t points, std::span<const RimEdge> rim,
                        Ground* ground);

}  // namespace liftmesh
