// LFRes with the restricted region as a range query: of the points that the region excludes, only
// those in cells at its edge are read.
//
// Only points inside the box of the circle (C), on the open side of e, can be below a plane through
// e. So a grid enumerates the points of the cells that meet that box. A point that is found below
// becomes the next candidate: the plane turns about e, and since the circles through a and b are
// nested on the open side, the region shrinks with it and no point need be read twice. No point is
// below the last candidate. The plane is vertical at first: all points to the right of e are below
// it and the region is unbounded; it is searched in circles of doubling size.
//
// All coordinates are relative to a, on a paraboloid with its vertex q at a. The paper leaves q
// free, and this choice is the best: d = 0, gamma = 0, r = L_cq, and coordinates are small.
#pragma once

#include "base/status.hpp"
#include "paper/facet_search.hpp"
#include "paper/grid.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh::paper {

class LfResIndexed {
 public:
    // `points` are in the order of the grid.
    LfResIndexed(const Grid& grid, const Point* points, Guard guard, Interrupt& interrupt)
        : grid_(grid), p_(points), guard_(guard), patience_(interrupt) {}

    // As LF(e, P): the third vertex of the facet to the right of e, or none.
    std::optional<Vertex> operator()(Vertex a, Vertex b);

    const Counts& counts() const { return counts_; }
    bool interrupted() { return patience_.ends(0); }

 private:
    struct Edge;
    struct Plane;
    struct Errors;
    class Growth;
    class Runs;

    Errors errors_within(const Edge& e, const Box& box) const;
    Box region(const Edge& e, const Plane& plane, const Errors& errors) const;
    bool turn(const Edge& e, const Box& box, const Errors& errors, Plane& plane);
    std::uint64_t turn_by_doubles(const Edge& e, Grid::Run run, const Errors& errors, Plane& plane);
    bool turn_exactly(const Edge& e, Grid::Run run, Plane& plane);
    bool is_below(const Edge& e, const Plane& plane, Vertex v) const;

    const Grid& grid_;
    const Point* p_;
    Guard guard_;
    Patience patience_;
    Counts counts_;
};

}  // namespace liftmesh::paper
