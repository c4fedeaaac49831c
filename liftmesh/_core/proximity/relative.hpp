// Relative neighbours, and the minimum spanning tree among them.
//
// A point eliminates an edge ab if it is strictly nearer to both ends than these are to each other.
// The edges that p eliminates form paths through the triangulation (J. W. Jaromczyk and M.
// Kowaluk, "A note on relative neighborhood graphs", SoCG 1987): let p be on one side of ab and c
// the corner of the triangle on the other.
//
//   - If p eliminates ab and ac, then ac is longer than bc. For c is not inside the circle through
//     p, a and b, whose angles at a and b are acute: so c is not nearer to p than to both a and b.
//     As it is nearer to p than to a, |bc| <= |pc| < |ac|. So the edge that a path goes on to does
//     not depend on p: it is the longer of both.
//   - Every edge that some point eliminates is on such a path, which begins at the side opposite
//     this point in one of its triangles: if p eliminates ac beyond a triangle abc, and b does not,
//     then p eliminates ab or bc, whichever is between. (From there on towards p, circles hold ever
//     less of it, so this ends.)
//
// So edges that are eliminated from one side are joined with what follows, by union-find, and each
// path goes on from the first that is not eliminated yet: a point is compared with nearly as many
// edges as there are, O(n a(n)) in all.
#pragma once

#include "base/status.hpp"
#include "proximity/sides.hpp"

namespace liftmesh {

// Its ends, as numbers of vertices.
using Edge = std::array<std::int32_t, 2>;
using Edges = std::vector<Edge>;

bool find_relative_neighbors(const EdgeSides& sides, Interrupt& interrupt, Edges& edges);

// Leaves the minimum spanning tree of a graph that contains it (J. B. Kruskal, 1956).
bool span(const EdgeSides& sides, Interrupt& interrupt, Edges& edges);

}  // namespace liftmesh
