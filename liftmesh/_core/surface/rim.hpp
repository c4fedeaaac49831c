// The rim of the faces that are shown: the sides beyond which there is no face.
#pragma once

#include "base/status.hpp"
#include "delaunay/triangulated.hpp"
#include "surface/first_faces.hpp"

namespace liftmesh {

// Leaves out every face that has a long side on the rim, again and again, as the rim moves inwards.
// Which these are does not depend on the order. `is_long` has three flags for each simplex, as the
// neighbours; `left_out` is changed. False if the interrupt came first.
bool leave_out_from_rim(const std::int32_t* neighbors, std::size_t count,
                        const std::uint8_t* is_long, std::uint8_t* left_out, Interrupt& interrupt);

// The closed curves of the rim as rows: one after the other, without repeating the first of each.
struct Rings {
    std::vector<std::int32_t> rows;
    std::vector<std::int64_t> starts;  // and the end of the last
};

// Faces are on the left of a ring: outer ones turn counter-clockwise, those around gaps clockwise.
// No ring visits a vertex twice: where the rim touches itself, it is cut into several. Each begins
// at its lexicographically least vertex, and they are in the order of these, then of the second.
bool rings(const Triangulated& mesh, Shown shown, Rings& found, Interrupt& interrupt);

}  // namespace liftmesh
