// The triangulation that is verified: positions, and triangles over them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/point.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh {

// A side of a triangle, as the triangle has it on its left. `place` is that of the corner it faces.
struct Side {
    Row tail, head;
    std::uint32_t place;
};

struct Subject {
    const Point* points;
    std::size_t rows;
    const std::int32_t* simplices;  // count x 3
    std::size_t count;
    Guard guard;                           // of the points
    const std::uint32_t* order = nullptr;  // the number each triangle was given, where not its own
    bool turned = false;                   // the last two corners of each stand the other way round

    Row corner(std::size_t place) const { return static_cast<Row>(simplices[place]); }
    Point point(std::size_t place) const { return points[corner(place)]; }

    // The place where the caller has the corner.
    std::size_t given(std::size_t place) const {
        const std::size_t triangle = order == nullptr ? place / 3 : order[place / 3];
        const std::size_t corner = turned ? (3 - place % 3) % 3 : place % 3;
        return 3 * triangle + corner;
    }

    Side side(std::size_t triangle, int k) const {
        const std::size_t first = 3 * triangle;
        constexpr int next[] = {1, 2, 0, 1};
        return {corner(first + next[k]), corner(first + next[k + 1]),
                static_cast<std::uint32_t>(first + k)};
    }
};

// Triangles, or rows, that are looked at as one task. The number does not depend on the threads,
// and so nothing that is found does.
inline constexpr std::size_t block = std::size_t{1} << 15;

inline std::size_t blocks(std::size_t count) {
    return (count + block - 1) / block;
}

}  // namespace liftmesh
