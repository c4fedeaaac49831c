// Checks of the kernel beyond the triangulation itself; a case selects one.
#pragma once

#include "case.hpp"
#include "delaunay/delaunay.hpp"
#include "expectation.hpp"
#include "structure.hpp"

namespace fuzzing {

// Interrupts a run when it polls for the n-th time.
class Impatient final : public liftmesh::Interrupt {
 public:
    explicit Impatient(std::size_t patience = ~std::size_t{0}) : patience_(patience) {}
    bool requested() override { return asked_ >= patience_ || ++asked_ >= patience_; }
    bool was_requested() const { return asked_ >= patience_; }

 private:
    std::size_t patience_, asked_ = 0;
};

using Corners = std::vector<std::int32_t>;

// Changes the set of the triangles found: flips an edge, turns, drops or repeats one, or moves a
// corner.
void damage(Case& c, const liftmesh::Delaunay& found, Corners& corners);

// A gift-wrapping engine finds the same triangles.
void check_engine(Case& c, const liftmesh::Delaunay& found);

// find_simplex gives the least triangle that contains a point: a vertex, or inside, or outside.
void check_location(Case& c, const liftmesh::Delaunay& found, const Rows& rows);

// The signs of the predicates and their filters are those of their definitions.
void check_predicates(Case& c, const Rows& rows);

// The lower hull of rows in space: two engines have one result, with no point below it.
void check_lower_hull(Case& c, const Expectation& expected);

// The verifier accepts the triangulation and rejects any damaged one.
void check_verification(Case& c, const liftmesh::Delaunay& found);

// Weights, radii and the farthest site: every edge is locally convex, and every other row above.
void check_family(Case& c, const Expectation& expected);

// Points that are inserted and removed leave the triangles of a fresh run.
void check_changes(Case& c, const Rows& rows);

// The verifier accepts the graph of disks around the rows, and no other; filters are exact.
void check_disks(Case& c, const Rows& rows);

// The star of a row in its own metric is that of the triangulation in this metric.
void check_stars(Case& c, const Rows& rows);

// An interrupted run says so, unless it finished before.
void check_interruption(Case& c, const liftmesh::Delaunay& found);

}  // namespace fuzzing
