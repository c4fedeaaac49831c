// Voronoi and power cells inside a domain: polygons with holes, of any number of parts.
//
// 1. Each ring of the domain is followed from cell to cell (`passages.cpp`). What of it lies in
//    one cell is a *passage*: it comes in over a ridge, passes corners of the domain, and leaves
//    over a ridge; or it is a whole ring. The inside of the domain is to its left.
// 2. In a cell with passages, the ends of these are put into the order in which they lie around the
//    cell. From the end of a passage the boundary of the clipped cell goes on along the ridges,
//    counter-clockwise, to where the next passage begins, and so back to the first (Weiler and
//    Atherton, 1977). Two passages over one ridge are ordered by which side of one edge the other
//    lies on: edges of a valid domain do not cross.
// 3. A ridge on the way that no passage crosses is inside the domain, and so is the whole cell
//    beyond it, if it has no passages of its own: from there a search finds all such cells.
//
// All decisions are exact signs of the coordinates given. What is written of a corner is where it
// comes from; coordinates are computed from that.
#pragma once

#include "cells/diagram.hpp"

namespace liftmesh {

// Rings of corners: those from starts[i] to starts[i + 1]. An edge has the number of the corner
// from which it leads to the next one of its ring. The inside is to the left.
struct Domain {
    const Point* corners;
    const std::int32_t* starts;
    std::size_t rings;
};

// Where a corner of a clipped cell comes from.
struct Corner {
    // An edge of the domain that crosses the ridge between the cell and `other`; or a corner of the
    // domain, and `other` is -1; or -1, and `other` is a triangle, whose vertex it is.
    std::int32_t edge, other;
    std::int32_t
        beyond;  // the row beyond the side that leads to the next corner, or -1: the domain
};

// What the perturbation decides: a corner of the domain on the ridge of two rows, or an edge that
// lies along it, with both ends of equal power.
struct Tie {
    std::int32_t corner, edge;  // one of them; -1 for the other
    std::int32_t cell, row;
};

struct Clipped {
    std::vector<Corner> corners;
    // Of the corners of the first rings, which are cut: those of whole cells are vertices, and
    // vertices are left for the caller.
    std::vector<Point> points;
    std::vector<bool> certain;         // whether a point is rounded correctly
    std::vector<std::int64_t> starts;  // of the rings, and the end
    std::size_t cut = 0;               // the first rings, which are not of whole cells
    std::vector<std::int32_t> cells;   // of the rings
    std::vector<Tie> ties;             // in no particular order; some more than once
};

enum class Clipping : std::uint8_t { done, interrupted, not_simple };

Clipping clip(const Dual& dual, const std::int32_t* vertex_of, const Spokes& spokes,
              const Domain& domain, Interrupt& interrupt, Clipped& clipped);

// The rings of a domain, cut into passages through cells.

struct CrossedRidge {
    std::int32_t edge = -1;  // none: the passage is a whole ring
    std::int32_t row = -1;   // the cell on the other side of the ridge
    Point at = {};
    bool is_certain = false;
};

struct Passage {
    std::int32_t cell, ring;
    std::int32_t first, count;  // corners passed, in a circle
    CrossedRidge in, out;

    bool is_ring() const { return out.edge < 0; }
};

// The rows must be those of the triangles: if the walk along a ring does not end where it began,
// the outcome is `not_simple`.
Clipping find_passages(const Dual& dual, const Spokes& spokes, const Domain& domain,
                       Interrupt& interrupt, std::vector<Passage>& found, std::vector<Tie>& ties);

}  // namespace liftmesh
