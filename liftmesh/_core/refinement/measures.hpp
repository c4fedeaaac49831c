// Lengths and angles in doubles. They decide what is refined and where a point goes, but not what
// is a triangle. Coordinates are scaled by a power of two, so that squares stay in range.
#pragma once

#include "base/point.hpp"

namespace liftmesh::refinement {

struct Vector {
    double x, y;
};

inline double dot(Vector a, Vector b) {
    return a.x * b.x + a.y * b.y;
}
inline double cross(Vector a, Vector b) {
    return a.x * b.y - a.y * b.x;
}
inline double square(Vector a) {
    return dot(a, a);
}

// A corner, seen along both sides.
struct Corner {
    double dot, squares;

    Corner(Vector a, Vector b) : dot(refinement::dot(a, b)), squares(square(a) * square(b)) {}

    // Whether it is less than an acute angle with this square of the cosine.
    bool is_less(double cosine2) const { return dot > 0 && dot * dot > cosine2 * squares; }
    // Whether it is more than 180 degrees less that angle.
    bool is_wide(double cosine2) const { return dot < 0 && dot * dot >= cosine2 * squares; }
};

class Measures {
 public:
    // Of coordinates of this magnitude at most.
    explicit Measures(double greatest) {
        constexpr int near = 300;  // squares of squares stay in range
        const int exponent = greatest == 0 ? 0 : std::ilogb(greatest);
        if (std::abs(exponent) <= near) return;
        first_ = std::ldexp(1.0, -exponent / 2);
        second_ = std::ldexp(1.0, -exponent - -exponent / 2);
    }

    double scaled(double length) const { return length * first_ * second_; }
    Vector between(Point from, Point to) const {
        return {scaled(to.x) - scaled(from.x), scaled(to.y) - scaled(from.y)};
    }
    Point moved(Point from, Vector by) const {
        return {from.x + by.x / first_ / second_, from.y + by.y / first_ / second_};
    }

 private:
    double first_ = 1, second_ = 1;  // two factors: one might overflow
};

// The point between two others, from the first on at the power of two that is the nearest to the
// middle.
inline Point at_shell(Point from, Point to, const Measures& measures) {
    const double length = std::sqrt(square(measures.between(from, to)));
    const double part = std::ldexp(1.0, std::ilogb(length / 1.5)) / length;
    return {std::lerp(from.x, to.x, part), std::lerp(from.y, to.y, part)};
}

inline Point middle(Point a, Point b) {
    return {std::midpoint(a.x, b.x), std::midpoint(a.y, b.y)};
}

// A point itself, or one of the eight whose coordinates are the next doubles.
inline Point beside(Point p, std::size_t which) {
    constexpr double far = std::numeric_limits<double>::max();
    const auto next = [](double x, std::size_t side) {
        return side == 0 ? x : std::nextafter(x, side == 1 ? far : -far);
    };
    return {next(p.x, which % 3), next(p.y, which / 3)};
}

}  // namespace liftmesh::refinement
