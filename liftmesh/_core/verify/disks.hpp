// Whether arrays from any source are the Delaunay graph of disks.
#pragma once

#include "apollonius/apollonius.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"

namespace liftmesh {

// Places are triangles, edges, places in the hull, or rows. Edge 3 t + k is opposite corner k
// of triangle t; after these come the pairs of the hull, then the edges to infinity, from the
// second disk of each pair.
// MEANINGS in disks/verification.py has the same names in the same order.
enum class DiskFlaw : std::uint8_t {
    invalid_index,     // an entry that is no row, or of the neighbours no triangle: list, and place
    degenerate,        // a triangle of which a disk is in another
    no_circle,         // a triangle with no circle that touches its disks in their order
    wrong_neighbors,   // an edge, of which the neighbour has not the reverse or names another
    wrong_hull,        // a place in the hull: it does not go on, or its edge has no other side
    boundary_winding,  // the hull, and how often it winds around
    not_delaunay,      // an edge: a disk on one side enters the circle on the other
    wrong_order,       // an edge: the circle on its right comes after that on its left
    not_canonical,     // an edge that the rule for ties would not have chosen
    missing_vertices,  // a row that is nowhere
    wrong_hidden,      // a row said to be hidden, and why it is not
    wrong_duplicates,  // a row said to be a duplicate, and of which
    other_circles,     // a triangle whose circle has other numbers
    kinds
};

// Why a row is not hidden.
enum class NotHidden : std::uint8_t { has_triangles, listed_twice, in_no_other };

struct DiskGraph {
    std::span<const apollonius::Disk> disks;
    std::span<const std::int32_t> simplices, neighbors, hull, hidden, duplicates;
    std::span<const double> circles;
};

struct DiskVerdict {
    Status status = Status::ok;
    std::size_t vertices = 0;
    FlawsOf<DiskFlaw> flaws;
};

// The disks are as for `apollonius::apollonius`, the lists have whole rows, and of neighbours and
// circles as many as of simplices. The secret is for the search of disks that hide others.
DiskVerdict verify(const DiskGraph& graph, std::uint64_t secret, Threads threads,
                   Interrupt& interrupt);

}  // namespace liftmesh
