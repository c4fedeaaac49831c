// Graphs of points that are near each other, from their Delaunay triangulation. Every decision is
// exact, so each graph depends on the points alone:
//
//     Gabriel (K. R. Gabriel and R. R. Sokal, 1969): no other point is in the closed disc with the
//         edge as its diameter.
//     Relative neighbours (G. T. Toussaint, 1980): no other point is strictly nearer to both ends
//         than these are to each other.
//     The minimum spanning tree: of edges of one length the one with the lexicographically lesser
//         end counts as shorter, or with the lesser other end.
//     The sphere of influence (G. T. Toussaint, 1988): the circles around both ends, each through
//         the point nearest to its centre, meet in two points.
//
// Each but the last is a part of the one before, and all of every Delaunay triangulation; circles
// of the last may also meet across edges.
#pragma once

#include "base/status.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

enum class Proximity : std::uint8_t {
    gabriel,
    relative_neighborhood,
    minimum_spanning_tree,
    sphere_of_influence
};

// Of a triangulation that is Delaunay by its points alone, without flaws: the rows of both ends of
// each edge, once. False if interrupted.
bool find_proximity_graph(const Triangulated& mesh, Proximity kind, Interrupt& interrupt,
                          std::vector<std::array<std::int32_t, 2>>& edges);

// The distance between both ends of each edge, to the nearest double.
bool find_lengths(const Input& points, std::span<const std::array<std::int32_t, 2>> edges,
                  Interrupt& interrupt, double* lengths);

}  // namespace liftmesh
