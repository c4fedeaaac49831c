// The triangles that change around an edge that ceases to be a constraint.
//
// The triangles that it would cross, if it were put in again, are those that come now: a strip from
// one of its ends, a, to the other. All others stay, and so do their edges. So the strip is found
// from a on, triangle after triangle, as two triangulations are merged (Guibas and Stolfi 1985):
// its last edge, from l to r, crosses the one that is released, and its next triangle has a
// neighbour of l or of r as third vertex. On either side, the neighbours beyond the edge from l to
// r are passed in turn, as long as the old triangle between one and the next conflicts with the
// other end; of the two that are left, the one inside the circle of the other comes next. Each
// triangle is passed once for each vertex: the time is linear in their number.
#pragma once

#include "dynamic/patch.hpp"
#include "dynamic/slots.hpp"
#include "predicates/incircle.hpp"

namespace liftmesh::dynamic {

class Release {
 public:
    Release(const Point* points, const Slots& slots, Guard guard)
        : points_(points), slots_(slots), guard_(guard) {}

    // The triangles that go, and those that come: none, where the edge is locally Delaunay.
    void plan(Edge e, std::vector<TriangleId>& gone, Patch& patch);

 private:
    // A side of the edge: the vertex of the strip's last edge, and the triangle up to which its
    // neighbours are passed, by the edge opposite to it.
    struct Side {
        bool is_left;
        Vertex at;
        Edge corner;
    };
    // A side of the strip: the edge in the old triangle, and that of the new one.
    struct Rim {
        Edge old;
        Edge local;
        bool operator<(Rim other) const { return old < other.old; }
    };

    Point point(Vertex v) const { return points_[v]; }
    Vertex ahead(const Side& side) const {
        return side.is_left ? slots_.head(side.corner) : slots_.tail(side.corner);
    }
    // The edge to the vertex ahead, in the triangle that goes.
    Edge rim(const Side& side) const {
        return side.is_left ? next(side.corner) : previous(side.corner);
    }
    bool conflicts(TriangleId t, Vertex v) const;
    bool is_valid(Vertex c) const;
    void pass(Side& side);
    bool pass_conflicts(Side& side, Vertex other);
    void move_ahead(Side& side, Vertex other);
    void begin(Edge e);
    bool extend();
    void join(Patch& patch);

    const Point* points_;
    const Slots& slots_;
    Guard guard_;
    Side left_{true, ghost, 0}, right_{false, ghost, 0};
    Edge last_ = 0;  // of the strip, by its local name
    std::vector<TriangleId>* gone_ = nullptr;
    Patch* patch_ = nullptr;
    std::vector<Rim> rims_;
};

}  // namespace liftmesh::dynamic
