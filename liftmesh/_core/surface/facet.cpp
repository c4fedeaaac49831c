#include "surface/facet.hpp"

#include "base/input.hpp"

namespace liftmesh {

namespace {

constexpr double least_share = 0x1p-10;  // of its bounding box that a plain triangle takes
constexpr double least_area = 0x1p-900, largest_area = 0x1p900;
constexpr double least_rise = 0x1p-400;

double between(double z, double least, double greatest) {
    return std::min(std::max(z, least), greatest);
}

}  // namespace

double blend(double za, double zb, double zc, Weights weights) {
    const double least = std::min({za, zb, zc}), greatest = std::max({za, zb, zc});
    const double z = za + (weights.of_b * (zb - za) + weights.of_c * (zc - za));
    if (std::isfinite(z)) return between(z, least, greatest);
    const double half =
        za / 2 + (weights.of_b * (zb / 2 - za / 2) + weights.of_c * (zc / 2 - za / 2));
    return between(half, least / 2, greatest / 2) * 2;
}

double share_between(Point u, Point v, Point query) {
    double dx = v.x - u.x, dy = v.y - u.y;
    double from_x = query.x - u.x, from_y = query.y - u.y;
    if (!std::isfinite(dx) || !std::isfinite(dy)) {
        dx = v.x / 2 - u.x / 2;
        dy = v.y / 2 - u.y / 2;
        from_x = query.x / 2 - u.x / 2;
        from_y = query.y / 2 - u.y / 2;
    }
    return std::fabs(dx) >= std::fabs(dy) ? from_x / dx : from_y / dy;
}

double height_between(SurfaceCorner u, SurfaceCorner v, Point query) {
    if (before_xy(v.at, u.at)) std::swap(u, v);
    return blend(u.height, v.height, u.height, {share_between(u.at, v.at, query), 0});
}

SurfaceFacet::SurfaceFacet(const SurfaceCorner& p, const SurfaceCorner& q, const SurfaceCorner& r)
    : a_(p), b_(q), c_(r) {
    if (before_xy(q.at, a_.at) && before_xy(q.at, r.at)) {
        a_ = q, b_ = r, c_ = p;
    } else if (before_xy(r.at, a_.at)) {
        a_ = r, b_ = p, c_ = q;
    }
    bx_ = b_.at.x - a_.at.x;
    by_ = b_.at.y - a_.at.y;
    cx_ = c_.at.x - a_.at.x;
    cy_ = c_.at.y - a_.at.y;
    rise_b_ = b_.height - a_.height;
    rise_c_ = c_.height - a_.height;
    least_ = std::min({p.height, q.height, r.height});
    greatest_ = std::max({p.height, q.height, r.height});
    const double area = bx_ * cy_ - by_ * cx_;
    const double width = std::max(bx_, cx_);
    const double height = std::max({by_, cy_, 0.0}) - std::min({by_, cy_, 0.0});
    inverse_ = 1 / area;
    is_stout_ = area > least_area && area < largest_area && area > least_share * (width * height);
    is_plain_ = is_stout_ && std::isfinite(rise_b_) && std::isfinite(rise_c_);
}

// Of a plain triangle the determinants do not cancel, relative to the steepness.
Point SurfaceFacet::gradient() const {
    const double rise = std::max(std::fabs(rise_b_), std::fabs(rise_c_));
    const Point slopes{(rise_b_ * cy_ - rise_c_ * by_) * inverse_,
                       (rise_c_ * bx_ - rise_b_ * cx_) * inverse_};
    if (is_plain_ && (rise == 0 || rise > least_rise) && is_finite(slopes)) return slopes;
    return exact_slopes({a_.at, b_.at, c_.at}, {a_.height, b_.height, c_.height});
}

}  // namespace liftmesh
