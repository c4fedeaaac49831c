// The ellipse through a point p and two others, a circle in the metric of p: which points lie in
// it.
//
// Relative to p, with Q the quadratic form of the metric, a point u is inside if
//
//     det(a, b) Q(u) - w . u < 0,   det(a, b) > 0,
//
// with w the vector for which det(a, b) Q(v) = w . v at both a and b. In floating point, each
// product is off by few units u = 2^-53 of the same product of magnitudes: differences by one, Q by
// 6, det by 4, w by 9, and the sum by 13 at most. The bound takes 32, and something absolute for
// underflow: coordinates and metrics are at most 1.
//
// The left side is convex, so in a box it is at least what a tangent plane has at its lowest
// corner: one at a point of the box where it is about least, which may be rounded.
#pragma once

#include "base/point.hpp"
#include "sorting/kd_tree.hpp"

namespace liftmesh::anisotropic {

// The matrix [[a, b], [b, c]].
struct Metric {
    double a, b, c;

    double square(Point u) const { return (a * u.x + b * u.y) * u.x + (b * u.x + c * u.y) * u.y; }
    double largest_square(Point u) const {
        const Point v{std::fabs(u.x), std::fabs(u.y)};
        return Metric{a, std::fabs(b), c}.square(v);
    }
};

class Ellipse {
 public:
    // Through the origin, a and b: counter-clockwise, relative to p.
    Ellipse(const Metric& metric, Point a, Point b) : metric_(metric), scale_(scale_of(a, b)) {
        a = times_scale(a);
        b = times_scale(b);
        det_ = a.x * b.y - a.y * b.x;
        largest_det_ = std::fabs(a.x * b.y) + std::fabs(a.y * b.x);
        const double of_a = metric.square(a), of_b = metric.square(b);
        const double most_a = metric.largest_square(a), most_b = metric.largest_square(b);
        w_ = {of_a * b.y - of_b * a.y, of_b * a.x - of_a * b.x};
        largest_w_ = {most_a * std::fabs(b.y) + most_b * std::fabs(a.y),
                      most_b * std::fabs(a.x) + most_a * std::fabs(b.x)};
    }

    // Negative inside, but for rounding.
    double depth(Point u) const { return at(times_scale(u)); }

    // 1 outside, -1 inside, 0 if rounding may decide.
    int side(Point u) const {
        u = times_scale(u);
        const double value = at(u), bound = bound_at({std::fabs(u.x), std::fabs(u.y)});
        return value > bound ? 1 : value < -bound ? -1 : 0;
    }

    // Whether all points of a box, relative to p, are surely outside.
    bool is_beyond(const TreeBox& given) const {
        const TreeBox box{times_scale(given.centre), times_scale(given.half)};
        const Point z = about_deepest(box);
        const double slope_x = 2 * det_ * (metric_.a * z.x + metric_.b * z.y) - w_.x;
        const double slope_y = 2 * det_ * (metric_.b * z.x + metric_.c * z.y) - w_.y;
        const double down_x = slope_x * (box.centre.x - z.x) - std::fabs(slope_x) * box.half.x;
        const double down_y = slope_y * (box.centre.y - z.y) - std::fabs(slope_y) * box.half.y;
        return at(z) + down_x + down_y > bound_at({std::fabs(box.centre.x) + 2 * box.half.x,
                                                   std::fabs(box.centre.y) + 2 * box.half.y});
    }

 private:
    // A power of two that makes a and b about 1, so that nothing of the ellipse underflows.
    static double scale_of(Point a, Point b) {
        const double largest = std::fmax(std::fmax(std::fabs(a.x), std::fabs(a.y)),
                                         std::fmax(std::fabs(b.x), std::fabs(b.y)));
        int exponent = 0;
        std::frexp(largest, &exponent);
        return std::ldexp(1, std::min(-exponent, 1000));
    }
    Point times_scale(Point u) const { return {u.x * scale_, u.y * scale_}; }

    double at(Point u) const { return det_ * metric_.square(u) - (w_.x * u.x + w_.y * u.y); }

    // Where the left side is about least in a box: along one axis after the other.
    Point about_deepest(const TreeBox& box) const {
        const auto nearest = [](double value, double centre, double half) {
            const double low = centre - half, high = centre + half;
            // Unlike fmax and fmin, these are no calls; what is no number becomes `low`, as well.
            const double above = value > low ? value : low;
            return above < high ? above : high;
        };
        Point z = box.centre;
        for (int round = 0; round < 2; ++round) {
            const double x = (w_.x / (2 * det_) - metric_.b * z.y) / metric_.a;
            z.x = nearest(x, box.centre.x, box.half.x);
            const double y = (w_.y / (2 * det_) - metric_.b * z.x) / metric_.c;
            z.y = nearest(y, box.centre.y, box.half.y);
        }
        return z;
    }

    double bound_at(Point most) const {
        constexpr double relative = 64 * 0x1p-53, least = 1e-300;
        const double reach = 1 + most.x + most.y, underflow = least * reach * reach;
        return relative * (largest_det_ * metric_.largest_square(most) + largest_w_.x * most.x +
                           largest_w_.y * most.y) +
               underflow;
    }

    Metric metric_;
    double scale_, det_, largest_det_;
    Point w_, largest_w_;
};

}  // namespace liftmesh::anisotropic
