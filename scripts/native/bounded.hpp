// What a refinement starts from: a triangulation whose hull is made of constraints, too.
#pragma once

#include <algorithm>

#include "constrained/constrained.hpp"

namespace native {

inline liftmesh::constrained::Piece side(const liftmesh::Result& found, std::size_t t, unsigned k) {
    const auto corner = [&](unsigned i) {
        return static_cast<liftmesh::Row>(found.simplices[3 * t + (k + i) % 3]);
    };
    return {std::min(corner(1), corner(2)), std::max(corner(1), corner(2))};
}

inline void bound(liftmesh::Constrained& mesh) {
    for (std::size_t t = 0; t < mesh.result.triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k) {
            if (mesh.result.neighbors[3 * t + k] >= 0 || (mesh.marks[t] >> k & 1)) continue;
            mesh.marks[t] |= static_cast<std::uint8_t>(1u << k);
            mesh.pieces.push_back(side(mesh.result, t, k));
        }
    std::sort(mesh.pieces.begin(), mesh.pieces.end());
}

}  // namespace native
