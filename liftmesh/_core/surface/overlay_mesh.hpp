// The overlay of two surfaces as a mesh: all pieces that faces have in common, triangulated.
//
// Its rows are vertices of both and the crossings of sides, rounded once. Rounding may move what is
// near to other things across these. So what it has left is checked: all rows are apart, pieces are
// still convex, and turn left at each corner. Then the triangles are counter-clockwise, and they
// cover no place twice if the rest of the plane does not either, of which the rim is the border:
// a closed curve around which triangles are on its left covers each place as often as it winds
// around it. Where the check fails, another way is needed.
//
// It would fail wherever a vertex of one surface is beside a side of the other by less than what
// crossings are rounded by: where the coordinates are decimals, of nearly every vertex that is on a
// side in decimals. So such vertices count as on these sides, and as one with a vertex that is as
// near, and it is the check that tells whether this has led to a triangulation. If not, all is
// decided exactly; then more counts as near, and faces as flat as that, as along hulls, are left
// out.
//
// Triangles of a piece are Delaunay in it. Sides of pieces are constraints where the triangles on
// both sides are not Delaunay, and on the rim: so the whole is constrained Delaunay (Lee and Lin,
// 1986), and depends on the surfaces alone.
#pragma once

#include "parallel/thread_pool.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

struct OverlayMesh {
    bool is_sound = true;  // false where the check failed, or the surfaces are no triangulations
    Buffer<Point> points;  // by x, then y
    Buffer<double> rises;  // of the first surface over the second
    Buffer<std::int32_t> simplices, neighbors;  // -1 beyond the rim
    Buffer<std::uint8_t> bits;                  // of each triangle: the sides that are constraints
    std::size_t rows = 0, triangles = 0, crossings = 0;
    double displacement = 0;  // the largest distance of a crossing from its sides
};

// From a face of each surface that touch. False if the interrupt came first.
bool overlay_mesh(const Relief& first, const Relief& second, std::int32_t face, std::int32_t other,
                  OverlayMesh& found, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
