// Heights on one face: a function of the coordinates of its corners alone, so that neither the
// order of rows, nor the triangle by which a point was reached, nor the number of threads changes a
// bit of it.
//
// Strictly inside, z = za + u (zb - za) + v (zc - za), where a is the lexicographically least
// corner, b and c follow it counter-clockwise, and u and v are quotients of areas. On an edge the
// height comes from its two ends, the lexicographically lesser first; at a vertex it is the
// vertex's own. It is never beyond the heights of the corners.
//
// Areas are rounded determinants as long as the triangle is at least a thousandth of its bounding
// box: then their errors, bounded as those of `orient2d`, are below 2^-39 of the triangle's area.
// Exact determinants give the weights and the gradient in thinner triangles.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "predicates/exact_weights.hpp"

namespace liftmesh {

struct SurfaceCorner {
    Point at;
    double height;
};

// What is linear in the weights of b and c.
double blend(double za, double zb, double zc, Weights weights);

// On the edge of two corners, at a point exactly on it.
double height_between(SurfaceCorner u, SurfaceCorner v, Point query);

class SurfaceFacet {
 public:
    // Corners in counter-clockwise order.
    SurfaceFacet(const SurfaceCorner& p, const SurfaceCorner& q, const SurfaceCorner& r);

    // At a point strictly inside.
    double height(Point query) const {
        return is_plain_ ? plain_height(query)
                         : blend(a_.height, b_.height, c_.height,
                                 exact_weights(a_.at, b_.at, c_.at, query));
    }

    // Whether `plain_height` may be asked.
    bool is_plain() const { return is_plain_; }
    double plain_height(Point query) const { return plain_height(query.x, query.y); }
    Pair plain_heights(Pair x, Pair y) const { return plain_height(x, y); }

    // Of the plane of the face: dz/dx and dz/dy.
    Point gradient() const;

 private:
    // Of one point or of two: the same bits.
    template <class Real>
    Real plain_height(Real at_x, Real at_y) const {
        constexpr auto all = spread<Real>;
        const Real x = at_x - all(a_.at.x), y = at_y - all(a_.at.y);
        const Real u = (x * all(cy_) - y * all(cx_)) * all(inverse_);
        const Real v = (all(bx_) * y - all(by_) * x) * all(inverse_);
        const Real z = all(a_.height) + (u * all(rise_b_) + v * all(rise_c_));
        const Real raised = z < all(least_) ? all(least_) : z;
        return raised > all(greatest_) ? all(greatest_) : raised;
    }

    SurfaceCorner a_, b_, c_;  // a is the lexicographically least
    double bx_, by_, cx_, cy_, rise_b_, rise_c_, inverse_, least_, greatest_;
    bool is_plain_;
};

}  // namespace liftmesh
