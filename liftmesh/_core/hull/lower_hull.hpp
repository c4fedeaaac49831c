// From the caller's rows in space to the facets of their lower hull.
#pragma once

#include "base/facets.hpp"
#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/delaunay.hpp"
#include "paper/facet_search.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient3d.hpp"

namespace liftmesh {

enum class HullMethod : std::uint8_t { incremental, lf };

// Rows have three columns, all finite. Of the rows at one planar position only the lowest can be on
// the lower hull: it represents them, the first if several are lowest. `secret` salts the order in
// which `incremental` inserts points, and changes nothing of the result. `counts` is filled by
// `lf`.
Delaunay lower_hull(const Input& input, HullMethod method, std::uint64_t secret, Threads threads,
                    Interrupt& interrupt, paper::Counts& counts);

// The lower hull of points in space: randomised incremental construction with conflict lists.
//
// Every point below the current hull waits at one facet that it is below: the one that contains its
// planar position, or a ghost beyond the planar hull. A point is inserted by removing the facets
// that it is below and joining it to the rim of the hole; points that waited there move to the new
// facets, found by their angle around it, and those that are above stay above for good. Rounds of
// doubling size, in kd order inside a round, keep memory accesses local while the expected number
// of moves stays O(n log n) on every input (N. Amenta, S. Choi and G. Rote, "Incremental
// constructions con BRIO", 2003; K. L. Clarkson and P. W. Shor, 1989).
//
// The expectation is over the choice of rounds, so it holds for an input only if the choice does
// not depend on it, nor the input on the choice: whoever knows the rounds beforehand can make an
// input that takes quadratic time. So a secret salts the choice. The facets do not depend on it,
// and they are put into an order that does not either: each begins with its least vertex, and they
// ascend by it, then by the vertex that follows. No two are equal in both, for a directed edge
// belongs to one facet.

// `points` have distinct planar positions, preferably in an order that keeps neighbours together.
// There are no facets if the positions are collinear. The result is the same for every `secret`.
Status incremental_hull(std::span<const SpacePoint> points, Guard guard, std::uint64_t secret,
                        Interrupt& interrupt, std::vector<Facet>& facets);

// The paper's procedures as engines: planar points are lifted and wrapped facet by facet.

enum class Procedure : std::uint8_t { lf, lfres, lfres_indexed };

// The Delaunay triangulation by Algorithm 2. `q` is the vertex of the paraboloid.
Delaunay wrap_delaunay(const Input& input, bool skip_non_finite, Procedure procedure, Point q,
                       Threads threads, Interrupt& interrupt, paper::Counts& counts);

}  // namespace liftmesh
