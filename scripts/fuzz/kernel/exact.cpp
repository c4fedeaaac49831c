#include "exact.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "integer.hpp"

namespace fuzzing {

namespace {

using Integers = std::vector<Integer>;

struct Parts {
    std::int64_t mantissa;
    int exponent;
};

Parts parts(double value) {
    int exponent = 0;
    auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
    exponent -= 53;
    for (; mantissa != 0 && mantissa % 2 == 0; ++exponent) mantissa /= 2;
    return {mantissa, exponent};
}

// A value in units of 2^low.
Integer in_units(double value, int low) {
    const Parts p = parts(value);
    return value == 0 ? Integer() : Integer(p.mantissa, static_cast<unsigned>(p.exponent - low));
}

// The coarsest lattice 2^low that holds all values, but no coarser than 2^low.
template <class Values>
int lattice_of(const Values& values, int low = std::numeric_limits<int>::max()) {
    for (const double value : values)
        if (value != 0) low = std::min(low, parts(value).exponent);
    return low;
}

Integers on_lattice(std::initializer_list<double> values) {
    const int low = lattice_of(values);
    Integers result;
    for (const double value : values) result.push_back(in_units(value, low));
    return result;
}

int turn_of(const Integers& x, const Integers& y, std::size_t i, std::size_t j, std::size_t k,
            Integer& result) {
    result = x[i] * (y[j] - y[k]) + x[j] * (y[k] - y[i]) + x[k] * (y[i] - y[j]);
    return result.sign();
}

// The corners, the one that is lifted most first.
std::array<std::size_t, 4> by_lift(const std::array<Point, 4>& corners) {
    std::array<std::size_t, 4> order = {0, 1, 2, 3};
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        const Point p = corners[i], q = corners[j];
        return p.x != q.x ? p.x > q.x : p.y > q.y;
    });
    return order;
}

int sign_of(const std::array<Point, 4>& corners, const Integers& x, const Integers& y,
            const Integers& z, bool canonical) {
    constexpr std::size_t others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    Integer determinant;
    int slope[4];  // the sign of the change of the determinant as a corner is lifted
    for (std::size_t i = 0; i < 4; ++i) {
        Integer area;
        const int sign = turn_of(x, y, others[i][0], others[i][1], others[i][2], area);
        slope[i] = i % 2 == 0 ? sign : -sign;
        const Integer term = z[i] * area;
        determinant = i % 2 == 0 ? determinant + term : determinant - term;
    }
    if (determinant.sign() != 0 || !canonical) return determinant.sign();
    for (const std::size_t i : by_lift(corners))
        if (slope[i] != 0) return slope[i];
    return 0;
}

Integer height(const Integers& x, const Integers& y, std::size_t i, std::size_t q) {
    const Integer dx = x[i] - x[q], dy = y[i] - y[q];
    return dx * dx + dy * dy;
}

// Coordinates of four points, x and y on one lattice.
struct Coordinates {
    Integers x, y;

    explicit Coordinates(const std::array<Point, 4>& p) {
        Integers all = on_lattice({p[0].x, p[1].x, p[2].x, p[3].x, p[0].y, p[1].y, p[2].y, p[3].y});
        x.assign(all.begin(), all.begin() + 4);
        y.assign(all.begin() + 4, all.end());
    }
};

// The height of a point, with coordinates in units of 2^low, in units of its square.
Integer lifted(Lift lift, const Integer& x, const Integer& y, double value, int low) {
    const Integer square = x * x + y * y, radius = in_units(value, low);
    switch (lift) {
        case Lift::weights:
            return square - in_units(value, 2 * low);
        case Lift::radii:
            return square - radius * radius;
        case Lift::metric:
            return Integer(form[0], 0) * x * x + Integer(2 * form[1], 0) * x * y +
                   Integer(form[2], 0) * y * y;
        case Lift::farthest:
            break;
    }
    return -square;
}

}  // namespace

int turn(Point a, Point b, Point c) {
    const Coordinates at({a, b, c, c});
    Integer area;
    return turn_of(at.x, at.y, 0, 1, 2, area);
}

int incircle(Point a, Point b, Point c, Point d, bool canonical) {
    const std::array<Point, 4> corners = {a, b, c, d};
    const Coordinates at(corners);
    Integers z;
    for (std::size_t i = 0; i < 4; ++i) z.push_back(at.x[i] * at.x[i] + at.y[i] * at.y[i]);
    return sign_of(corners, at.x, at.y, z, canonical);
}

int lifted_side(Lift lift, const std::array<Point, 4>& corners, const std::array<double, 4>& values,
                bool canonical) {
    int low = lattice_of(values, 0);
    for (const Point p : corners) low = lattice_of(std::array{p.x, p.y}, low);
    Integers x, y, z;
    for (std::size_t i = 0; i < 4; ++i) {
        x.push_back(in_units(corners[i].x, low));
        y.push_back(in_units(corners[i].y, low));
        z.push_back(lifted(lift, x[i], y[i], values[i], low));
    }
    return sign_of(corners, x, y, z, canonical);
}

int orient3d(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d, bool canonical) {
    const std::array<Point, 4> corners = {a.planar(), b.planar(), c.planar(), d.planar()};
    const Coordinates at(corners);
    return sign_of(corners, at.x, at.y, on_lattice({a.z, b.z, c.z, d.z}), canonical);
}

int insphere(const SpacePoint (&points)[5], bool canonical) {
    int low = std::numeric_limits<int>::max();
    for (const SpacePoint& p : points) low = lattice_of(std::array{p.x, p.y, p.z}, low);
    Integers x, y, z;
    for (const SpacePoint& p : points) {
        x.push_back(in_units(p.x, low));
        y.push_back(in_units(p.y, low));
        z.push_back(in_units(p.z, low));
    }
    Integer determinant;
    int slope[5];  // the sign of the change of the determinant as a point is lifted
    for (std::size_t i = 0; i < 5; ++i) {
        std::array<std::size_t, 4> others;
        for (std::size_t k = 0; k < 4; ++k) others[k] = k + (k >= i);
        Integer volume;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t a = k == 0 ? 1 : 0, b = k < 2 ? 2 : 1, c = k < 3 ? 3 : 2;
            Integer area;
            turn_of(x, y, others[a], others[b], others[c], area);
            const Integer term = z[others[k]] * area;
            volume = k % 2 == 0 ? volume + term : volume - term;
        }
        slope[i] = i % 2 == 0 ? volume.sign() : -volume.sign();
        const Integer term = (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]) * volume;
        determinant = i % 2 == 0 ? determinant + term : determinant - term;
    }
    if (determinant.sign() != 0 || !canonical) return determinant.sign();
    std::array<std::size_t, 5> order = {0, 1, 2, 3, 4};
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        const SpacePoint &p = points[i], &q = points[j];
        return p.x != q.x ? p.x > q.x : p.y != q.y ? p.y > q.y : p.z > q.z;
    });
    for (const std::size_t i : order)
        if (slope[i] != 0) return slope[i];
    return 0;
}

bool exceeds(SpacePoint a, SpacePoint b, SpacePoint c, SpacePoint d, double distance) {
    const Coordinates at({a.planar(), b.planar(), c.planar(), d.planar()});
    const Integers z = on_lattice({a.z, b.z, c.z, d.z, distance});
    Integer area, of_b, of_c;
    turn_of(at.x, at.y, 0, 1, 2, area);
    turn_of(at.x, at.y, 0, 3, 2, of_b);
    turn_of(at.x, at.y, 0, 1, 3, of_c);
    const Integer above = (z[3] - z[0]) * area - (z[1] - z[0]) * of_b - (z[2] - z[0]) * of_c;
    const Integer size = above.sign() < 0 ? -above : above;
    return (size - z[4] * area).sign() > 0;
}

int compare_distances(Point a, Point b, Point c, Point d) {
    const Coordinates at({a, b, c, d});
    return (height(at.x, at.y, 0, 1) - height(at.x, at.y, 2, 3)).sign();
}

int sign_at_apex(Point a, Point b, Point c) {
    const Coordinates at({a, b, c, c});
    return ((at.x[0] - at.x[2]) * (at.x[1] - at.x[2]) + (at.y[0] - at.y[2]) * (at.y[1] - at.y[2]))
        .sign();
}

bool do_circles_cross(Point a, Point p, Point b, Point q) {
    const Coordinates at({a, p, b, q});
    const Integer of_p = height(at.x, at.y, 0, 1), of_q = height(at.x, at.y, 2, 3);
    const Integer rest = height(at.x, at.y, 0, 2) - of_p - of_q;
    return rest.sign() < 0 || (rest * rest - (of_p + of_p) * (of_q + of_q)).sign() < 0;
}

int turn_in_oyz(Point a, Point b, Point c, Point q) {
    const Coordinates at({a, b, c, q});
    const auto z = [&](std::size_t i) {
        return height(at.x, at.y, i, 3) - height(at.x, at.y, 0, 3);
    };
    return ((at.y[1] - at.y[0]) * z(2) - (at.y[2] - at.y[0]) * z(1)).sign();
}

}  // namespace fuzzing
