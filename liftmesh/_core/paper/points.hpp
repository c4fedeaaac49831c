// The paper's P: points p_1 ... p_n in space, and the predicates on them.
//
// The names of the paper, which the files of this folder keep:
//   P, p_l       the points, and the candidate with which an edge spans a plane
//   e = [a, b]   an edge of the lower convex hull CH_L(P)
//   n, d         a plane's normal ab x ap and its offset: x n_x + y n_y + z n_z = d
//   q            the vertex of the paraboloid z = (x - q_x)^2 + (y - q_y)^2
//   (C), (E)     a plane cuts the paraboloid in the ellipse (E), whose projection is the circle (C)
//   L_cq         the distance from the centre c of (C) to q
//   E_L, E'_L    edges of which one facet is known, and edges that are settled
//   Q', Q        facets whose edges are still to be visited, and facets that are done
//
// The paper assumes that no four points are coplanar. Here any points of distinct planar positions
// are allowed: a symbolic perturbation lifts lexicographically larger points (by x, then y) by an
// infinitesimal more. So no point is ever on a plane of three others, and CH_L(P) is unique.
#pragma once

#include "base/point.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient3d.hpp"

namespace liftmesh::paper {

// The greatest magnitudes of the coordinates, and their ranges: they bound the rounding errors.
struct Extent {
    SpacePoint greatest{0, 0, 0};  // |x|, |y|, |z|
    SpacePoint spread{0, 0, 0};    // max - min, rounded up
};

// What both kinds of points share: the coordinates in which the dot products are computed.
class Points {
 public:
    std::size_t size() const { return p_.size(); }
    const SpacePoint* data() const { return p_.data(); }
    const SpacePoint& operator[](Vertex v) const { return p_[v]; }
    Point planar(Vertex v) const { return p_[v].planar(); }
    const Extent& extent() const { return extent_; }
    // The most by which a z differs from the height it stands for.
    double error_of_z() const { return error_of_z_; }
    // Whether the filters hold here: its margin is infinite if no rounded value may be trusted.
    Guard guard() const { return guard_; }

 protected:
    Points(std::vector<SpacePoint> p, Guard guard);

    std::vector<SpacePoint> p_;
    Extent extent_;
    double error_of_z_ = 0;
    Guard guard_;
};

// Planar points, lifted to the paraboloid with the vertex q. z is rounded and serves the filters;
// the planar points decide.
class LiftedPoints : public Points {
 public:
    LiftedPoints(std::span<const Point> planar, Point q, Guard guard);

    Point q() const { return q_; }
    int compare_z(Vertex u, Vertex v) const;
    int turn_in_oyz(Vertex u, Vertex v, Vertex w) const;
    // Whether v is below the plane (a, b, p); its normal points down: a, b, p turn clockwise.
    bool is_below(Vertex a, Vertex b, Vertex p, Vertex v) const {
        return incircle_canonical(planar(b), planar(a), planar(p), planar(v), guard());
    }

 private:
    Point q_;
};

// Points of any z.
class SpacePoints : public Points {
 public:
    SpacePoints(std::vector<SpacePoint> p, Guard guard) : Points(std::move(p), guard) {}

    int compare_z(Vertex u, Vertex v) const;
    int turn_in_oyz(Vertex u, Vertex v, Vertex w) const;
    bool is_below(Vertex a, Vertex b, Vertex p, Vertex v) const {
        return orient3d_canonical(p_[b], p_[a], p_[p], p_[v], guard());
    }
};

}  // namespace liftmesh::paper
