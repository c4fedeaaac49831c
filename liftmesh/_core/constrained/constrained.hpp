// Constrained Delaunay triangulations.
//
// Edges are given that the triangulation must have, whole or as a chain of edges between the points
// on them: the constraints. A triangulation with these edges is constrained Delaunay if every other
// edge is locally Delaunay (Lee and Lin, "Generalized Delaunay triangulation for planar graphs",
// 1986; Chew, "Constrained Delaunay triangulations", 1989). It is unique but for ties, and the rule
// for ties lifts all points of the plane to heights in general position: so with it the result
// depends on the points and the edges alone, not on their order, nor on how it was found.
//
// First the points are triangulated, without the edges: most of these are there already. The
// others are put in one after the other (insertion.hpp): an edge takes away the triangles that it
// crosses, and what it leaves on either side is filled (pocket.hpp). Last, slots become rows, and
// what the edges became is listed.
#pragma once

#include "base/input.hpp"
#include "delaunay/delaunay.hpp"

namespace liftmesh {

namespace constrained {

using EdgeId = std::uint32_t;

// A constraint as it is in the result: two rows, the lesser first, that are neighbours.
struct Piece {
    Row first, second;
    auto operator<=>(const Piece&) const = default;
};

// Two edges that cross at a point inside of both that is no row; the lesser first.
struct Crossing {
    EdgeId one, other;
    auto operator<=>(const Crossing&) const = default;
};

}  // namespace constrained

struct Constrained : Delaunay {
    std::vector<std::uint8_t> marks;         // of each triangle: bit k, the edge opposite vertex k
    std::vector<constrained::Piece> pieces;  // ascending
    std::vector<std::uint32_t> starts;       // of each piece among the members, and the end
    std::vector<constrained::EdgeId> members;      // the edges that a piece is part of, ascending
    std::vector<constrained::EdgeId> zero_length;  // edges whose ends are at one position
    std::vector<constrained::EdgeId> unplaced;     // edges with an end in a skipped row
    std::vector<constrained::Crossing> crossings;  // all there are, ascending
};

// `edges` are count x 2 rows. Without triangles, as where edges are unplaced, there are no pieces.
// If edges cross, only the crossings count.
Constrained constrained_delaunay(const Input& input, const std::int32_t* edges, std::size_t count,
                                 bool skip_non_finite, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
