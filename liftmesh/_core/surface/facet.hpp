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
#include "delaunay/triangulated.hpp"
#include "predicates/determinants.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

struct SurfaceCorner {
    Point at;
    double height;
};

// What is linear in the weights of b and c.
double blend(double za, double zb, double zc, Weights weights);

// On the edge of two corners, at a point exactly on it: the weight of v, which is not before u.
double share_between(Point u, Point v, Point query);
double height_between(SurfaceCorner u, SurfaceCorner v, Point query);

class SurfaceFacet {
 public:
    // Corners in counter-clockwise order.
    SurfaceFacet(const SurfaceCorner& p, const SurfaceCorner& q, const SurfaceCorner& r);

    // At a point strictly inside.
    double height(Point query) const {
        return is_plain_ ? plain_height(query)
                         : blend(a_.height, b_.height, c_.height, weights(query));
    }

    // Of b and c there.
    Weights weights(Point query) const {
        return is_stout_ ? plain_weights(query.x, query.y)
                         : exact_weights(a_.at, b_.at, c_.at, query);
    }

    // Whether `plain_height` may be asked.
    bool is_plain() const { return is_plain_; }
    double plain_height(Point query) const { return plain_height(query.x, query.y); }
    Pair plain_heights(Pair x, Pair y) const { return plain_height(x, y); }

    // Of the plane of the face: dz/dx and dz/dy.
    Point gradient() const;

 private:
    Weights plain_weights(double at_x, double at_y) const {
        const double x = at_x - a_.at.x, y = at_y - a_.at.y;
        return {(x * cy_ - y * cx_) * inverse_, (bx_ * y - by_ * x) * inverse_};
    }

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
    bool is_stout_, is_plain_;  // whether areas are exact enough, and differences of heights finite
};

// Where a level crosses a side: on the side from its lexicographically lesser end.

namespace detail {

inline double on_the_way(double from, double to, double share) {
    const double at = from + share * (to - from);
    const double kept = std::isfinite(at) ? at : (from / 2 + share * (to / 2 - from / 2)) * 2;
    return std::min(std::max(kept, std::min(from, to)), std::max(from, to));
}

}  // namespace detail

// One end is below the level, the other is not. An end at the level is the point itself.
inline Point crossing(SurfaceCorner u, SurfaceCorner v, double level) {
    if (before_xy(v.at, u.at)) std::swap(u, v);
    if (u.height == level) return u.at;
    if (v.height == level) return v.at;
    double share = (level - u.height) / (v.height - u.height);
    if (!std::isfinite(v.height - u.height))
        share = (level / 2 - u.height / 2) / (v.height / 2 - u.height / 2);
    return {detail::on_the_way(u.at.x, v.at.x, share), detail::on_the_way(u.at.y, v.at.y, share)};
}

// Where a point of a closed triangle lies: inside, on the side opposite corner k, or at corner k.

struct Place {
    enum Kind : std::uint8_t { inside, side, vertex, beyond } kind;
    int k;
};

inline Place place_in(const Triangulated& mesh, std::int32_t simplex, Point query) {
    int zeros = 0, on = 0, off = 0;
    for (int k = 0; k < 3; ++k) {
        const int turn =
            orient2d(mesh.corner(simplex, (k + 1) % 3), mesh.corner(simplex, (k + 2) % 3), query);
        if (turn < 0) return {Place::beyond, 0};
        (turn == 0 ? on : off) = k;
        zeros += turn == 0;
    }
    if (zeros == 0) return {Place::inside, 0};
    return zeros == 1 ? Place{Place::side, on} : Place{Place::vertex, off};
}

}  // namespace liftmesh
