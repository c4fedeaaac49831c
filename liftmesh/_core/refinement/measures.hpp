// Lengths and angles in doubles. They decide what is refined and where a point goes, but not what
// is a triangle. Coordinates are scaled by a power of two, so that squares stay in range.
#pragma once

#include "base/point.hpp"

namespace liftmesh::refinement {

struct Vector {
    double x, y;
};

inline Vector operator-(Vector a, Vector b) {
    return {a.x - b.x, a.y - b.y};
}
inline double dot(Vector a, Vector b) {
    return a.x * b.x + a.y * b.y;
}
inline double cross(Vector a, Vector b) {
    return a.x * b.y - a.y * b.x;
}
inline double square(Vector a) {
    return dot(a, a);
}

inline double length(Vector a) {
    return std::sqrt(square(a));
}

// A corner, seen along both sides.
class Corner {
 public:
    Corner(Vector a, Vector b) : dot_(refinement::dot(a, b)), a2_(square(a)), b2_(square(b)) {}

    double dot() const { return dot_; }
    // Whether it is less than an acute angle with this square of the cosine.
    bool is_less(double cosine2) const { return dot_ > 0 && cosine2_exceeds(cosine2); }
    // Whether it is at least 180 degrees less that angle.
    bool is_wide(double cosine2) const { return dot_ < 0 && !cosine2_is_below(cosine2); }

 private:
    // The product of short sides may be too small for a double.
    bool has_product() const { return a2_ * b2_ > std::numeric_limits<double>::min(); }
    double cosine2() const { return (dot_ / a2_) * (dot_ / b2_); }
    bool cosine2_exceeds(double other) const {
        return has_product() ? dot_ * dot_ > other * (a2_ * b2_) : cosine2() > other;
    }
    bool cosine2_is_below(double other) const {
        return has_product() ? dot_ * dot_ < other * (a2_ * b2_) : cosine2() < other;
    }

    double dot_, a2_, b2_;
};

class Measures {
 public:
    // Of coordinates of this magnitude at most.
    explicit Measures(double greatest) {
        constexpr int near = 200;  // squares of squares stay in range
        const int exponent = greatest == 0 ? 0 : std::ilogb(greatest);
        if (std::abs(exponent) <= near) return;
        first_ = std::ldexp(1.0, -exponent / 2);
        second_ = std::ldexp(1.0, -exponent - -exponent / 2);
    }

    double scaled(double length) const { return length * first_ * second_; }
    Vector scaled(Point p) const { return {scaled(p.x), scaled(p.y)}; }
    Vector between(Point from, Point to) const { return scaled(to) - scaled(from); }
    Point moved(Point from, Vector by) const {
        return {from.x + by.x / first_ / second_, from.y + by.y / first_ / second_};
    }

 private:
    double first_ = 1, second_ = 1;  // two factors: one might overflow
};

// The distance between doubles as large as a coordinate, or up to twice as much.
inline double ulp_at(Point p) {
    using Limits = std::numeric_limits<double>;
    return std::max(std::max(std::abs(p.x), std::abs(p.y)) * Limits::epsilon(),
                    Limits::denorm_min());
}

// As std::lerp, which some libraries compute with a fused product and sum.
inline double between(double a, double b, double share) {
    const auto [least, most] = std::minmax(a, b);
    if (least <= 0 && most >= 0) return share * b + (1 - share) * a;
    return std::clamp(a + share * (b - a), least, most);
}

inline Point along(Point from, Point to, double share) {
    return {between(from.x, to.x, share), between(from.y, to.y, share)};
}

// The point between two others, from the first on at the power of two that is the nearest to the
// middle.
inline Point at_shell(Point from, Point to, const Measures& measures) {
    const double whole = length(measures.between(from, to));
    const double part = std::ldexp(1.0, std::ilogb(whole / 1.5)) / whole;
    return along(from, to, part);
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
