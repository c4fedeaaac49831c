// The volumes between two surfaces, whose faces are laid over each other.
//
// All pairs that touch are found by a flood (flood.hpp). The part that two faces have in common
// follows from the same orientations (face_pair.hpp), and is measured in doubles, relative to a
// corner (common_part.hpp). If that is not enough for a 2^40th of all that was measured, as in
// slivers and between surfaces that almost coincide, double words are. Sums are exact and rounded
// once: the order of the faces changes no bit.
#pragma once

#include "surface/relief.hpp"

namespace liftmesh {

struct Between {
    double above, below, area;  // of the second over the first, and under it
};

// From a face of the first and one of the second that touch. False if the interrupt came first.
bool between(const Relief& first, const Relief& second, std::int32_t face, std::int32_t other,
             Between& found, Interrupt& interrupt);

// Triangles, counter-clockwise, that each have a point inside a face of the first and one of the
// second.
struct Parts {
    const double* corners;  // six numbers each
    const std::int32_t *faces, *others;
    std::size_t count;
};

// The same, as much of it as lies in any of the triangles, which do not overlap. Faces of the
// second are looked at for each face of the first that touches a triangle: the first should be the
// finer surface.
bool between_within(const Relief& first, const Relief& second, const Parts& parts, Between& found,
                    Interrupt& interrupt);

}  // namespace liftmesh
