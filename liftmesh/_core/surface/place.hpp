// Where a point of a closed triangle lies: inside, on the side opposite corner k, or at corner k.
#pragma once

#include <cstdint>

#include "delaunay/triangulated.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

struct Place {
    enum Kind : std::uint8_t { inside, side, vertex, beyond } kind;
    int k;
};

inline Place place_in(const Triangulated& mesh, std::int32_t simplex, Point query) {
    int zeros = 0, on = 0, off = 0;
    for (int k = 0; k < 3; ++k) {
        const int turn =
            orient2d(mesh.corner(simplex, (k + 1) % 3), mesh.corner(simplex, (k + 2) % 3), query);
        if (turn < 0) return {Place::beyond, 0};
        (turn == 0 ? on : off) = k;
        zeros += turn == 0;
    }
    if (zeros == 0) return {Place::inside, 0};
    return zeros == 1 ? Place{Place::side, on} : Place{Place::vertex, off};
}

}  // namespace liftmesh
