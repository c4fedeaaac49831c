#include "predicates/insphere.hpp"

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"
#include "predicates/lifted_determinant.hpp"

namespace liftmesh {

namespace {

// The filter outside the window, as that of incircle(): differences scaled so that the largest is
// near 1, where an underflow costs at most a few times 2^-1074.
int insphere_by_scaled_filter(const SpacePoint (&points)[5]) {
    std::array<SpaceSteps, 4> steps = {SpaceSteps(points[0], points[4]),
                                       {points[1], points[4]},
                                       {points[2], points[4]},
                                       {points[3], points[4]}};
    double largest = 0;
    for (const SpaceSteps& step : steps)
        largest = std::max(largest, largest_magnitude(step.x, step.y, step.z));
    if (!std::isfinite(largest) || largest < 0x1p-960) return 0;
    const double scale = std::ldexp(1.0, -std::ilogb(largest));
    for (SpaceSteps& step : steps) step.x *= scale, step.y *= scale, step.z *= scale;
    const auto& [p, q, r, s] = steps;
    const auto [det, square, volumes] = insphere_filter(p, q, r, s);
    const double error = insphere_error(p, q, r, s, square) + 1e-290;
    return (det > error) - (-det > error);
}

Lattice<15> lattice_of(const SpacePoint (&points)[5]) {
    std::array<double, 15> values;
    for (unsigned i = 0; i < 5; ++i) {
        values[3 * i] = points[i].x;
        values[3 * i + 1] = points[i].y;
        values[3 * i + 2] = points[i].z;
    }
    return Lattice<15>(values);
}

// The determinant with the rows (x, y, z, x^2 + y^2 + z^2), from differences to the fifth point.
// Where these are below 2^20, minors are below 2^63 and the whole below 2^107.
int sign_of_small_sphere(const std::int64_t (&x)[4], const std::int64_t (&y)[4],
                         const std::int64_t (&z)[4]) {
    Int128 det = 0;
    for (int i = 0; i < 4; ++i) {
        const int j = i == 0, k = i < 2 ? 2 : 1, l = i < 3 ? 3 : 2;
        const std::int64_t minor = z[j] * (x[k] * y[l] - x[l] * y[k]) +
                                   z[k] * (x[l] * y[j] - x[j] * y[l]) +
                                   z[l] * (x[j] * y[k] - x[k] * y[j]);
        const Int128 term = static_cast<Int128>(minor) * (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        det += i % 2 == 0 ? term : -term;
    }
    return (det > 0) - (det < 0);
}

// The same at any width: differences are below 2^(64N - 2), minors of two columns below
// 2^(128N - 3), of three below 2^(192N - 3), squares below 2^(128N - 2).
template <int N>
int sign_of_sphere(const std::array<Wide<N>, 4>& x, const std::array<Wide<N>, 4>& y,
                   const std::array<Wide<N>, 4>& z) {
    Wide<5 * N> det{};
    for (int i = 0; i < 4; ++i) {
        const int j = i == 0, k = i < 2 ? 2 : 1, l = i < 3 ? 3 : 2;
        const Wide<3 * N> minor = z[j] * (x[k] * y[l] - x[l] * y[k]) +
                                  z[k] * (x[l] * y[j] - x[j] * y[l]) +
                                  z[l] * (x[j] * y[k] - x[k] * y[j]);
        const Wide<5 * N> term = minor * (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        det = i % 2 == 0 ? det + term : det - term;
    }
    return det.sign();
}

// From differences of at most 62 bits.
int sign_of_narrow_sphere(const std::int64_t (&step)[3][4]) {
    constexpr std::int64_t small = std::int64_t{1} << 20;
    bool are_small = true;
    for (const auto& axis : step)
        for (std::int64_t value : axis) are_small &= (-small < value) & (value < small);
    if (are_small) return sign_of_small_sphere(step[0], step[1], step[2]);
    std::array<Wide<1>, 4> part[3];
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 4; ++i) part[axis][i] = {static_cast<std::uint64_t>(step[axis][i])};
    return sign_of_sphere<1>(part[0], part[1], part[2]);
}

template <int N>
int sign_of_sphere(const Lattice<15>& lattice) {
    std::array<Wide<N>, 4> part[3];
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 4; ++i)
            part[axis][i] = lattice.at<N>(3 * i + axis) - lattice.at<N>(12 + axis);
    return sign_of_sphere<N>(part[0], part[1], part[2]);
}

int sign_of_narrow_sphere(const Lattice<15>& lattice) {
    std::int64_t step[3][4];
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 4; ++i)
            step[axis][i] = static_cast<std::int64_t>(
                (lattice.at<1>(3 * i + axis) - lattice.at<1>(12 + axis)).limb[0]);
    return sign_of_narrow_sphere(step);
}

// The differences of integers to the last of some points.
template <int K>
void find_steps(const SpacePoint (&points)[K], double to_integers, std::int64_t (&step)[3][K - 1]) {
    std::int64_t at[3][K];
    for (int i = 0; i < K; ++i) {
        at[0][i] = static_cast<std::int64_t>(points[i].x * to_integers);
        at[1][i] = static_cast<std::int64_t>(points[i].y * to_integers);
        at[2][i] = static_cast<std::int64_t>(points[i].z * to_integers);
    }
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < K - 1; ++i) step[axis][i] = at[axis][i] - at[axis][K - 1];
}

bool is_odd(const std::array<int, 5>& order) {
    int inversions = 0;
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < i; ++j) inversions += order[j] > order[i];
    return inversions % 2 != 0;
}

// The determinant with the rows (x, y, z, x^2 + y^2 + z^2, 1), as the sum of all 360 products: the
// range of doubles costs no more than any other lattice.
int sign_of_wide_sphere(const Lattice<15>& lattice) {
    ExactSum<5> det(lattice.width());
    std::array<int, 5> row = {0, 1, 2, 3, 4};  // whose x, y, z, square and 1 are multiplied
    do {
        const Term<3> product = lattice.part(3 * row[0]) * lattice.part(3 * row[1] + 1) *
                                one_factor(lattice.part(3 * row[2] + 2));
        for (int axis = 0; axis < 3; ++axis) {
            const Dyadic factor = lattice.part(3 * row[3] + axis);
            const Term<5> term = product * (factor * factor);
            if (is_odd(row)) {
                det.add(term);
            } else {
                det.subtract(term);
            }
        }
    } while (std::next_permutation(row.begin(), row.end()));
    return det.sign();
}

}  // namespace

int volume_sign_exact(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                      const SpacePoint& d, const Trust& trust) {
    if (trust.to_integers == 0) return -orient3d_exact(a, b, c, d);
    std::int64_t step[3][3];
    find_steps({a, b, c, d}, trust.to_integers, step);
    Wide<3> det{};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Int128 minor = static_cast<Int128>(step[0][k]) * step[1][j] -
                             static_cast<Int128>(step[0][j]) * step[1][k];
        det = det + widened(minor) * Wide<1>{static_cast<std::uint64_t>(step[2][i])};
    }
    return det.sign();
}

int insphere_exact(const SpacePoint (&points)[5], const Trust& trust) {
    if (trust.to_integers != 0) {
        std::int64_t step[3][4];
        find_steps(points, trust.to_integers, step);
        return sign_of_narrow_sphere(step);
    }
    if (!trust.guard.vouches())
        if (const int sign = insphere_by_scaled_filter(points); sign != 0) return sign;
    const Lattice<15> lattice = lattice_of(points);
    if (lattice.fits<1>()) return sign_of_narrow_sphere(lattice);
    if (lattice.fits<2>()) return sign_of_sphere<2>(lattice);
    return sign_of_wide_sphere(lattice);
}

// As in the plane: the lexicographically largest point is lifted most. If it is the last, that
// leaves the sphere; otherwise the last replaces it in the tetrahedron, whose orientation is then
// the sign. Where the new one is flat, the next largest point decides.
bool is_inside_by_rule(const std::array<const SpacePoint*, 5>& points, const Trust& trust) {
    const SpacePoint& last = *points[4];
    for (unsigned done = 0; done != 0xf;) {
        unsigned largest = 4;
        for (unsigned i = 0; i < 4; ++i)
            if (!(done >> i & 1) && before_xyz(*points[largest], *points[i])) largest = i;
        if (largest == 4) return false;
        std::array<const SpacePoint*, 5> p = points;
        p[largest] = &last;
        const int sign = volume_sign(*p[0], *p[1], *p[2], *p[3], trust);
        if (sign != 0) return sign > 0;
        done |= 1u << largest;
    }
    return false;  // GCOV_EXCL_LINE: in one of four the last is opposite
}

int insphere_canonical_exact(const SpacePoint (&points)[5], const Trust& trust) {
    if (const int sign = insphere_exact(points, trust); sign != 0) return sign;
    const auto& [a, b, c, d, e] = points;
    const int whole = volume_sign_exact(a, b, c, d, trust);
    if (whole == 0 || std::find(points, points + 4, e) != points + 4) return 0;
    const bool is_inside = whole > 0 ? is_inside_by_rule({&a, &b, &c, &d, &e}, trust)
                                     : is_inside_by_rule({&b, &a, &c, &d, &e}, trust);
    return is_inside ? whole : -whole;
}

}  // namespace liftmesh
