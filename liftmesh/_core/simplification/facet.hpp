// A triangle of the approximation, and how far samples are from it, along the vertical.
//
// A distance is computed in doubles, with a bound on its error for the whole triangle; the bound
// holds for samples inside. Only where these leave open whether a distance exceeds the tolerance
// exact numbers decide: doubles, where coordinates and heights are few steps apart, or integers. So
// neither is a vertex spent on rounding, nor the tolerance exceeded by
// it.
#pragma once

#include "base/point.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

// Whether |z - plane(x, y)| > tolerance, exactly; the corners are counter-clockwise.
bool exceeds_exactly(const Sample (&corners)[3], const Sample& sample, double tolerance);

class Facet {
 public:
    Facet() = default;
    // Of corners counter-clockwise; which of them is the first does not matter.
    Facet(Sample a, Sample b, Sample c, const Tolerance& tolerance);

    double distance(const Sample& sample) const {
        const double dx = sample.point.x - corners_[0].point.x;
        const double dy = sample.point.y - corners_[0].point.y;
        return std::fabs((sample.height - corners_[0].height) - (slope_x_ * dx + slope_y_ * dy));
    }

    // Whether a sample at this computed distance is beyond the tolerance.
    bool exceeds(const Sample& sample, double distance) const {
        if (distance <= surely_within_) return false;
        if (distance > surely_beyond_) return true;
        if (is_corner(sample.point)) return false;
        if (is_exact_) return exceeds_in_doubles(sample);
        return exceeds_exactly(corners_, sample, tolerance_);
    }
    bool is_corner(Point p) const {
        return p == corners_[0].point || p == corners_[1].point || p == corners_[2].point;
    }
    double surely_within() const { return surely_within_; }

 private:
    bool exceeds_in_doubles(const Sample& sample) const {
        const double dx = sample.point.x - corners_[0].point.x;
        const double dy = sample.point.y - corners_[0].point.y;
        const double dz = sample.height - corners_[0].height;
        return std::fabs(dz * det_ - (rise_x_ * dx + rise_y_ * dy)) > tolerance_ * det_;
    }

    Sample corners_[3];
    double det_, rise_x_, rise_y_;  // slopes are these over the determinant
    double slope_x_, slope_y_;
    bool is_exact_;
    double tolerance_, surely_within_, surely_beyond_;
};

}  // namespace liftmesh::simplification
