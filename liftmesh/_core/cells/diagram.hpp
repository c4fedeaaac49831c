// The vertices of Voronoi and power diagrams, from the triangles that are dual to them.
//
// A vertex of the diagram belongs to all triangles whose lifted corners lie in one plane: sites on
// one circle share a vertex, however ties cut their polygon into triangles.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// Triangles of a finished triangulation over plain rows. Without values sites are not lowered.
struct Dual {
    enum class Kind : std::uint8_t { plain, weights, radii };

    const Point* points;
    const double* values;  // one for each row
    Kind kind;
    std::size_t rows;
    const std::int32_t *simplices, *neighbors;  // count x 3
    std::size_t count;

    std::int32_t vertex(std::int32_t t, int k) const { return simplices[word(t, k)]; }
    std::int32_t neighbor(std::int32_t t, int k) const { return neighbors[word(t, k)]; }
    // Which corner of a triangle a row is.
    int place(std::int32_t t, std::int32_t row) const {
        return (vertex(t, 1) == row) + 2 * (vertex(t, 2) == row);
    }

 private:
    static std::size_t word(std::int32_t t, int k) {
        return 3 * static_cast<std::size_t>(t) + static_cast<std::size_t>(k);
    }
};

struct Vertices {
    Buffer<Point> points;
    std::size_t count = 0;
    Buffer<std::int32_t> of;   // the vertex of each triangle
    std::size_t infinite = 0;  // vertices with a coordinate beyond the doubles
};

// False if the interrupt came first.
bool make_vertices(const Dual& dual, Threads threads, Interrupt& interrupt, Vertices& vertices);

// The edges at a site, counter-clockwise, and what lies between each and the next: a triangle, or
// nothing. They are dual to the ridges around its cell, and the triangles to its corners.

struct Spoke {
    std::int32_t row;
    std::int32_t triangle;  // before the next spoke; -1 at infinity
};

// A chain of rows instead of triangles has those on one line, in their order.
class Spokes {
 public:
    Spokes(const Dual& dual, const std::int32_t* chain, std::size_t length);

    bool has(std::int32_t row) const { return first_[row] != none; }
    // Replaces what is in `found`.
    void list(std::int32_t row, std::vector<Spoke>& found) const;
    // A row with a cell; -1 if there is none.
    std::int32_t any() const;

 private:
    static constexpr std::int32_t none = -1;

    const Dual& dual_;
    const std::int32_t* chain_;
    std::size_t length_;
    Buffer<std::int32_t> first_;  // the first triangle at a row, or its place in the chain
};

// The ridges and regions of Voronoi and power diagrams, from triangles and the vertex of each.
//
// A ridge is dual to an edge between two vertices, or leads from a vertex to infinity. The region
// of a site has as many corners as it has ridges, if infinity counts as one. No coordinate is read.

struct Regions {
    // The rows of the two sites of each ridge, and the vertices at its ends: the lesser first. A
    // ray has -1 for its first end; seen from its first site, the second is the next on the hull.
    Buffer<std::int32_t> ridge_sites, ridge_ends;
    std::size_t ridge_count = 0, edges = 0;  // there is room for as many ridges as edges
    // Corners starts[i] to starts[i + 1] are those of region i, counter-clockwise. Unbounded ones
    // come first, and begin with -1. Rows without a region have number -1.
    Buffer<std::int32_t> region_of, starts, corners;
    std::size_t region_count = 0;
};

// False if the interrupt came first.
bool make_regions(const Dual& dual, const std::int32_t* vertex_of, Interrupt& interrupt,
                  Regions& regions);

}  // namespace liftmesh
