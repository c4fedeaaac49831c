// Vectors in space, of doubles, double words or integers, and the steps between points as integers.
#pragma once

#include "predicates/lattice.hpp"
#include "predicates/orient3d.hpp"

namespace liftmesh {

inline constexpr double unit_roundoff = 0x1p-53;

// Where squares of steps are in this window, products of eight steps do not overflow, and what
// underflows is less than the errors that filters count anyway.
inline constexpr double least_square = 0x1p-200, greatest_square = 0x1p200;

template <class Number>
struct Vector {
    Number x, y, z;
};
template <class Number>
Vector(Number, Number, Number) -> Vector<Number>;  // older compilers do not find it themselves

inline Vector<double> step_between(const SpacePoint& from, const SpacePoint& to) {
    return {to.x - from.x, to.y - from.y, to.z - from.z};
}

template <class First, class Second>
auto operator*(const First& factor, const Vector<Second>& v) {
    return Vector{factor * v.x, factor * v.y, factor * v.z};
}

template <class Number>
Vector<Number> operator+(const Vector<Number>& a, const Vector<Number>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class First, class Second>
auto dot(const Vector<First>& a, const Vector<Second>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class First, class Second>
auto cross(const Vector<First>& a, const Vector<Second>& b) {
    return Vector{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Number>
auto square(const Vector<Number>& a) {
    return dot(a, a);
}

// K points on the common lattice of their coordinates.
template <int K>
class SpaceLattice : public Lattice<3 * K> {
 public:
    explicit SpaceLattice(const std::array<SpacePoint, K>& points)
        : Lattice<3 * K>(values(points)) {}

    template <int N>
    Vector<Wide<N>> step(int to, int from) const {
        const auto along = [&](int axis) {
            return this->template at<N>(3 * to + axis) - this->template at<N>(3 * from + axis);
        };
        return {along(0), along(1), along(2)};
    }

 private:
    static std::array<double, 3 * K> values(const std::array<SpacePoint, K>& points) {
        std::array<double, 3 * K> all;
        for (std::size_t i = 0; i < K; ++i) {
            all[3 * i] = points[i].x;
            all[3 * i + 1] = points[i].y;
            all[3 * i + 2] = points[i].z;
        }
        return all;
    }
};

}  // namespace liftmesh
