// A triangle of the approximation, and how far samples are from it, along the vertical.
//
// A distance is computed in doubles, with a bound on its error for the whole triangle; the bound
// holds for samples inside. Only where these leave open whether a distance exceeds the tolerance
// exact integers decide. So neither is a vertex spent on rounding, nor the tolerance exceeded by
// it.
#pragma once

#include <cmath>

#include "base/point.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

// A corner.
struct Corner {
    Point point;
    double height;
};

// Whether |z - plane(x, y)| > tolerance, exactly; the corners are counter-clockwise.
bool exceeds_exactly(const Corner (&corners)[3], const Corner& sample, double tolerance);

class Facet {
 public:
    Facet() = default;
    // Of corners counter-clockwise; which of them is the first does not matter.
    Facet(Corner a, Corner b, Corner c, double tolerance);

    double distance(const Sample& sample) const {
        const double dx = sample.point.x - corners_[0].point.x;
        const double dy = sample.point.y - corners_[0].point.y;
        return std::fabs((sample.height - corners_[0].height) - (slope_x_ * dx + slope_y_ * dy));
    }

    // Whether a sample at this computed distance is beyond the tolerance.
    bool exceeds(const Sample& sample, double distance) const {
        if (distance <= surely_within_) return false;
        if (distance > surely_beyond_) return true;
        return exceeds_exactly(corners_, {sample.point, sample.height}, tolerance_);
    }
    double surely_within() const { return surely_within_; }

 private:
    Corner corners_[3];
    double slope_x_, slope_y_;
    double tolerance_, surely_within_, surely_beyond_;
};

}  // namespace liftmesh::simplification
