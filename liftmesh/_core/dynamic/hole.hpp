// The hole that the star of a vertex leaves, and the canonical triangles that fill it.
#pragma once

#include <cstddef>

#include "dynamic/triangulation.hpp"

namespace liftmesh::dynamic {

struct Hole {
    const Point* points;
    const Star& star;
    Guard guard;

    // Whether all vertices of the link are on one line.
    bool is_flat() const;
    void lay_flat(Patch& patch) const;
    // By the apex of one edge after another.
    void cut(Patch& patch) const;
    // By a triangulation of the link.
    void fit(Patch& patch) const;

 private:
    Point at(std::size_t i) const { return points[star.link[i]]; }
    bool is_ghost(std::size_t i) const { return star.link[i] == ghost; }
    bool is_left(std::size_t tail, std::size_t head, std::size_t c) const;
    bool is_better(std::size_t tail, std::size_t head, std::size_t best, std::size_t c) const;
    std::size_t apex(std::size_t first, std::size_t last) const;
    Word cut(std::size_t first, std::size_t last, Patch& patch) const;
};

}  // namespace liftmesh::dynamic
