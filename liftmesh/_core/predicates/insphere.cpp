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
        largest = std::max(largest, largest_of(step.x, step.y, step.z));
    if (!std::isfinite(largest) || largest < 0x1p-960) return 0;
    const double scale = std::ldexp(1.0, -std::ilogb(largest));
    for (SpaceSteps& step : steps) step.x *= scale, step.y *= scale, step.z *= scale;
    const SphereFilter filter = insphere_filter(steps[0], steps[1], steps[2], steps[3]);
    const double error = filter.error + 1e-290;
    return (filter.det > error) - (-filter.det > error);
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
int sign_of_sphere(const Lattice<15>& lattice) {
    std::array<Wide<N>, 4> x, y, z;
    for (int i = 0; i < 4; ++i) {
        x[i] = lattice.at<N>(3 * i) - lattice.at<N>(12);
        y[i] = lattice.at<N>(3 * i + 1) - lattice.at<N>(13);
        z[i] = lattice.at<N>(3 * i + 2) - lattice.at<N>(14);
    }
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

int sign_of_narrow_sphere(const Lattice<15>& lattice) {
    constexpr std::int64_t small = std::int64_t{1} << 20;
    std::int64_t steps[3][4];
    bool are_small = true;
    for (int i = 0; i < 12; ++i) {
        const Wide<1> step = lattice.at<1>(i) - lattice.at<1>(12 + i % 3);
        const auto value = static_cast<std::int64_t>(step.limb[0]);
        steps[i % 3][i / 3] = value;
        are_small &= -small < value && value < small;
    }
    return are_small ? sign_of_small_sphere(steps[0], steps[1], steps[2])
                     : sign_of_sphere<1>(lattice);
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

int insphere_exact(const SpacePoint (&points)[5], Guard guard) {
    if (!guard.vouches())
        if (const int sign = insphere_by_scaled_filter(points); sign != 0) return sign;
    const Lattice<15> lattice = lattice_of(points);
    if (lattice.fits<1>()) return sign_of_narrow_sphere(lattice);
    if (lattice.fits<2>()) return sign_of_sphere<2>(lattice);
    return sign_of_wide_sphere(lattice);
}

int insphere_canonical_exact(const SpacePoint (&points)[5], Guard guard) {
    const int sign = insphere_exact(points, guard);
    return sign != 0 ? sign : perturbed_sign(points);
}

// As in the plane: the lexicographically largest point is lifted most. If it is the last, that
// leaves the sphere; otherwise the last replaces it in the tetrahedron, whose orientation is then
// the sign. Where the new one is flat, the next largest point decides.
int perturbed_sign(const SpacePoint (&points)[5]) {
    const auto volume_without = [&](int i) {
        SpacePoint p[4] = {points[0], points[1], points[2], points[3]};
        if (i < 4) p[i] = points[4];
        return volume_sign_exact(p[0], p[1], p[2], p[3]);
    };
    const int whole = volume_without(4);
    if (whole == 0 || std::find(points, points + 4, points[4]) != points + 4) return 0;
    int order[5] = {0, 1, 2, 3, 4};
    std::sort(order, order + 5, [&](int i, int j) { return before_xyz(points[j], points[i]); });
    for (int i : order) {
        if (i == 4) break;
        if (const int sign = volume_without(i); sign != 0) return sign;
    }
    return -whole;
}

}  // namespace liftmesh
