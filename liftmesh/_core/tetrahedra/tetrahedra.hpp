// From the caller's rows in space to the tetrahedra of their Delaunay triangulation.
#pragma once

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "parallel/thread_pool.hpp"
#include "sorting/space_order.hpp"

namespace liftmesh {

struct Tetrahedra {
    Status status = Status::ok;
    std::size_t row = 0;       // the first non-finite row, where that is the status
    std::size_t distinct = 0;  // how many positions there are
    std::vector<Row> witness;  // rows that span the line or plane of degenerate points
    std::vector<Duplicate> duplicates;
    std::vector<Row> skipped;
    Buffer<std::int32_t> simplices, neighbors;  // count x 4
    std::size_t count = 0;
    std::vector<std::array<std::int32_t, 3>> hull;  // counter-clockwise seen from outside
};

// The Delaunay triangulation by incremental insertion: every point removes the tetrahedra in whose
// spheres it lies, and joins the facets around them (A. Bowyer, 1981; D. F. Watson, 1981). Points
// on a sphere are decided by the symbolic perturbation that lifts lexicographically larger points
// more, so there is one result. Points come in a biased random order, salted by `secret`, and along
// a Hilbert curve in each round; each is found by a visibility walk from the one before.
//
// Tetrahedra are in the order of the curve, by their least vertex, then the others; each begins
// with its two least. So simplices, neighbours and hull depend on the coordinates alone, as a list.
Tetrahedra tetrahedralize(const Input& input, bool skip_non_finite, std::uint64_t secret,
                          Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
