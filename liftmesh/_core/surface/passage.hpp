// The faces that segments touch, by a flood from one of them across sides that touch the segment,
// too. The triangulation covers a convex region, so all are reached. Exact orientations decide.
#pragma once

#include "base/status.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

struct Segments {
    const double* ends;          // four numbers each
    const std::int32_t* starts;  // a triangle that each touches; -1 if there is none
    std::size_t count;
};

// Pairs, by segment.
struct Passages {
    std::vector<std::int32_t> segments, faces;
};

// False if the interrupt came first.
bool find_passages(const Triangulated& mesh, const Segments& segments, Passages& found,
                   Interrupt& interrupt);

}  // namespace liftmesh
