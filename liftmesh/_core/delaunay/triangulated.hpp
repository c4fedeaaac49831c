// The caller's finished triangulation, read in place by point location.
#pragma once

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "base/pair.hpp"

namespace liftmesh {

struct Triangulated {
    Input points;
    const std::int32_t* simplices;  // count x 3, counter-clockwise
    const std::int32_t* neighbors;  // count x 3; entry k is opposite vertex k; -1 outside
    std::size_t count;
    const Point* plain =  // the points, if they are laid out like this
        points.is_plain() ? reinterpret_cast<const Point*>(points.data) : nullptr;

    Pair place(std::int32_t row) const {
        return plain ? pair(plain + row) : pair(points[static_cast<std::size_t>(row)]);
    }
    std::int32_t vertex(std::int32_t simplex, int k) const {
        return simplices[3 * static_cast<std::ptrdiff_t>(simplex) + k];
    }
    Point corner(std::int32_t simplex, int k) const {
        return points[static_cast<std::size_t>(vertex(simplex, k))];
    }
    std::int32_t neighbor(std::int32_t simplex, int k) const {
        return neighbors[3 * static_cast<std::ptrdiff_t>(simplex) + k];
    }
    Pair place(std::int32_t simplex, int k) const { return place(vertex(simplex, k)); }
    [[gnu::always_inline]] void prefetch(std::int32_t simplex) const {
        liftmesh::prefetch(simplices + 3 * static_cast<std::ptrdiff_t>(simplex));
        liftmesh::prefetch(neighbors + 3 * static_cast<std::ptrdiff_t>(simplex));
    }
    // The k of a neighbour, without a branch.
    int place_of_neighbor(std::int32_t simplex, std::int32_t other) const {
        return (neighbor(simplex, 1) == other) + 2 * (neighbor(simplex, 2) == other);
    }
};

}  // namespace liftmesh
