// Pairs the half-edges of the triangles into edges, finds the boundary, and tests whether the edges
// between two triangles are locally Delaunay.
#pragma once

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"

namespace liftmesh {

// Whether the boundary of the triangles is one closed convex curve that winds around once.

struct Boundary {
    Flaws flaws;
    std::size_t uncovered = 0;  // vertices at which no triangle covers the direction upwards
};

// Checks half-edges without a twin. False if the interrupt came first.
bool check_boundary(const MeshView& mesh, const std::vector<HalfEdge>& edges, ThreadPool& pool,
                    Boundary& boundary);

// Reorders triangles so that neighbours in the plane are close in memory.

struct Gathered {
    Buffer<std::int32_t> simplices;  // count x 3
    Buffer<std::uint32_t> order;     // the number of each in the mesh
};

// Leaves `gathered` empty if the triangles are few, or in such an order already. All corners must
// be rows. False if the interrupt came first.
bool gather(const MeshView& mesh, ThreadPool& pool, Gathered& gathered);

// Rows that share a position; those of different values, where there are values, do not.

// One byte for each row: whether it is a corner.
using Marks = std::vector<std::uint8_t>;

// Adds every finite row that has no vertex at its position. False if the interrupt came first.
bool find_missing(const MeshView& mesh, const Marks& vertices, ThreadPool& pool, Flaws& flaws);

// The lowest row at the position of each finite row. False if the interrupt came first.
bool find_lowest(const MeshView& mesh, ThreadPool& pool, std::vector<Row>& lowest);

// An edge that the perturbation, or even the in-circle test, would flip: the places of its two
// half-edges.
struct FlippableEdge {
    std::uint32_t one, other;
    bool not_delaunay;
};

struct EdgePairing {
    Flaws triangles;                       // what is wrong with them
    std::vector<std::uint32_t> turned;     // all that are clockwise or degenerate
    std::size_t covering = 0;              // triangles that cover the direction upwards at a corner
    std::vector<FlippableEdge> flippable;  // in no particular order
    std::size_t interior_edges = 0;        // between two triangles
    std::vector<HalfEdge> boundary;        // half-edges without a twin
};

// Checks each triangle and pairs its half-edges with those of its neighbours. All corners must be
// rows; triangles with non-finite corners are left out. False if the interrupt came first.
//
// Of an edge with several triangles on one side, as many half-edges are paired as can be, and the
// others are left to the boundary; which ones depends on the order of the triangles.
//
// Where the view has a place for neighbours, they are filled in: -1 beyond the boundary.
bool pair_edges(const MeshView& mesh, ThreadPool& pool, EdgePairing& pairing);

// Edges with several triangles on one side.

// Adds those edges to `flaws`, and removes them from `pairing.flippable`: which of their half-edges
// are twins is undecidable. What is left does not depend on the order of the triangles. False if
// the interrupt came first.
bool separate_repeated(const MeshView& mesh, const Marks& corners, ThreadPool& pool,
                       EdgePairing& pairing, Flaws& flaws);

}  // namespace liftmesh
