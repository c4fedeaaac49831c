// Contours of a surface, as lines over its faces.
//
// A corner is above a level if its height is at least the level. So a face has no side that a level
// crosses, or two, and lines end only where faces do: they need no rule for corners at the level.
// Faces are followed across the sides, with what is above on the left. On a side, the point comes
// from its lexicographically lesser end: it is the same from both faces. Where the level is that of
// a corner, the point is the corner, and points that follow each other at one position are one: a
// plateau at the level has a line around it, a ridge one there and back, and a summit none.
//
// The mesh is read in the order of its faces only: each step of a line is computed there, and put
// into the list of its level . Then the steps of a level are linked, by the places
// of faces in the list, and lines are followed through that list, which the cache holds.
#pragma once

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

struct Contours {
    Buffer<Point> points;
    std::vector<std::int64_t> starts;  // of lines in the points, and the end of the last
    std::vector<std::int32_t> levels;  // of each line, as places in the list
    std::vector<std::uint8_t> is_closed;
};

// The lines of all levels, which ascend. A closed line has its first point at its end, too; it
// begins at its lexicographically least point. The lines of a level are in lexicographic order.
// False if the interrupt came first.
bool contours(const Relief& relief, const double* levels, std::size_t count, Contours& found,
              Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
