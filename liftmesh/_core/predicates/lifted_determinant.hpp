// The determinant behind the side test of lifted points, in exact integers: positive where the lift
// of the last point is below the plane of the other three, which turn counter-clockwise.
#pragma once

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"
#include "predicates/lift.hpp"
#include "predicates/wide.hpp"

namespace liftmesh {

// Lifted points as exact integers: each height is a sum of products of few mantissas.
//
// On the lattice 2^low of the coordinates, |p|^2 is an integer multiple of 2^(2 low). Radii share
// this lattice. A weight must be a multiple of 2^(2 low), and at most as long as a square: so low
// is at most half of its least exponent. The coefficients of a metric have a lattice of their own:
// multiplying all of them by a power of two changes no sign.

template <class Lift, int K>
PlanarLattice<K> planar_lattice(const Lifted<Lift> (&sites)[K]) {
    Point points[K];
    for (int i = 0; i < K; ++i) points[i] = sites[i].point;
    return PlanarLattice<K>(points);
}

template <class Lift, int K>
class LiftedLattice : public PlanarLattice<K> {
 public:
    LiftedLattice(Lift, const Lifted<Lift> (&sites)[K]) : PlanarLattice<K>(planar_lattice(sites)) {
        for (int i = 0; i < K; ++i) {
            value_[i] = dyadic(sites[i].value);
            if (value_[i].mantissa == 0) continue;
            const int low = value_[i].exponent, high = low + bit_length(value_[i].mantissa);
            this->include(is_square ? low : halved_down(low), is_square ? high : halved_up(high));
        }
    }

    static constexpr int factors = 2;
    std::array<Term<2>, 3> height(int i) const {
        const Dyadic x = this->part_of_x(i), y = this->part_of_y(i);
        Term<2> lowering = this->lowering(i);
        lowering.negative = !lowering.negative;
        return {x * x, y * y, lowering};
    }

    // What is subtracted from the square, as an integer multiple of 2^(2 low).
    Term<2> lowering(int i) const {
        const auto [mantissa, exponent] = value_[i];
        if (mantissa == 0) return {};
        if constexpr (is_square) {
            const Dyadic radius{mantissa, exponent - this->low()};
            return radius * radius;
        } else {
            const auto size = static_cast<std::uint64_t>(mantissa < 0 ? -mantissa : mantissa);
            return {{size, 0}, exponent - 2 * this->low(), mantissa < 0};
        }
    }

 private:
    static constexpr bool is_square = std::is_same_v<Lift, ByRadius>;
    static constexpr int halved_down(int exponent) { return exponent >> 1; }
    static constexpr int halved_up(int exponent) { return (exponent + 1) >> 1; }

    Dyadic value_[K];
};

template <int K>
class LiftedLattice<Paraboloid, K> : public PlanarLattice<K> {
 public:
    LiftedLattice(Paraboloid, const Lifted<Paraboloid> (&sites)[K])
        : PlanarLattice<K>(planar_lattice(sites)) {}

    static constexpr int factors = 2;  // of a height
    std::array<Term<2>, 2> height(int i) const {
        const Dyadic x = this->part_of_x(i), y = this->part_of_y(i);
        return {x * x, y * y};
    }
};

template <int K>
class LiftedLattice<ByMetric, K> : public PlanarLattice<K> {
 public:
    LiftedLattice(ByMetric metric, const Lifted<ByMetric> (&sites)[K])
        : PlanarLattice<K>(planar_lattice(sites)), form_({metric.a, metric.b, metric.c}) {}

    static constexpr int factors = 3;
    std::array<Term<3>, 3> height(int i) const {
        const Dyadic x = this->part_of_x(i), y = this->part_of_y(i);
        Term<3> mixed = x * y * one_factor(form_.part(1));
        ++mixed.shift;
        return {x * x * one_factor(form_.part(0)), mixed, y * y * one_factor(form_.part(2))};
    }
    int width() const { return std::max(PlanarLattice<K>::width(), form_.width() + 1); }
    const Lattice<3>& form() const { return form_; }

 private:
    Lattice<3> form_;
};

// The determinant behind the side tests of points in space and of weighted ones, in exact integers.

// The sign of the determinant with the rows (dx_i, dy_i, dz_i). Each dx and dy is below 2^(64N - 2)
// in magnitude, each dz below 2^(128N - 2): no term reaches 2^(256N - 5).
template <int N>
int sign_of_volume(const std::array<Wide<N>, 3>& dx, const std::array<Wide<N>, 3>& dy,
                   const std::array<Wide<2 * N>, 3>& dz) {
    Wide<4 * N> det{};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        det = det + dz[i] * (dx[j] * dy[k] - dx[k] * dy[j]);
    }
    return det.sign();
}

// Heights are those of the points minus that of the last one, sheared so that |p|^2 becomes the
// square of the distance from it.
template <class Lift>
concept Lowers = requires(const LiftedLattice<Lift, 4>& lattice) { lattice.lowering(0); };

inline Wide<2> whole(const Term<2>& term) {
    const Uint128 size =
        (static_cast<Uint128>(term.magnitude.limb[1]) << 64 | term.magnitude.limb[0]) << term.shift;
    const Uint128 value = term.negative ? -size : size;
    return {static_cast<std::uint64_t>(value), static_cast<std::uint64_t>(value >> 64)};
}

inline Int128 narrow(const Wide<2>& value) {
    return static_cast<Int128>(static_cast<Uint128>(value.limb[1]) << 64 | value.limb[0]);
}

inline bool is_below_2_to_30(std::int64_t value) {
    return -(1 << 30) < value && value < (1 << 30);
}

// Differences below 2^30 and heights below 2^62 keep the whole determinant below 2^127.
inline int sign_in_128_bits(const std::int64_t (&dx)[3], const std::int64_t (&dy)[3],
                            const std::int64_t (&dz)[3]) {
    Int128 det = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        det += static_cast<Int128>(dz[i]) * (dx[j] * dy[k] - dx[k] * dy[j]);
    }
    return (det > 0) - (det < 0);
}

// By how much each of the first three points is lowered more than the last: below 2^123.
template <class Lift>
std::array<Wide<2>, 3> excesses(const LiftedLattice<Lift, 4>& lattice) {
    const Wide<2> last = whole(lattice.lowering(3));
    return {whole(lattice.lowering(0)) - last, whole(lattice.lowering(1)) - last,
            whole(lattice.lowering(2)) - last};
}

// From differences of at most 62 bits. (Points that nothing lowers have less to multiply:
// incircle.cpp.)
template <Lowers Lift>
int sign_of_side(const LiftedLattice<Lift, 4>& lattice) {
    std::array<Wide<1>, 3> dx, dy;
    std::int64_t sx[3], sy[3], sz[3];
    for (int i = 0; i < 3; ++i) {
        dx[i] = lattice.template x<1>(i) - lattice.template x<1>(3);
        dy[i] = lattice.template y<1>(i) - lattice.template y<1>(3);
        sx[i] = static_cast<std::int64_t>(dx[i].limb[0]);
        sy[i] = static_cast<std::int64_t>(dy[i].limb[0]);
    }
    bool small =
        std::all_of(sx, sx + 3, is_below_2_to_30) && std::all_of(sy, sy + 3, is_below_2_to_30);
    const std::array<Wide<2>, 3> excess = excesses(lattice);
    for (const Wide<2>& each : excess) {
        const Int128 value = narrow(each);
        small &= -(Int128{1} << 60) < value && value < (Int128{1} << 60);
    }
    if (small) {
        for (int i = 0; i < 3; ++i)
            sz[i] = sx[i] * sx[i] + sy[i] * sy[i] - static_cast<std::int64_t>(narrow(excess[i]));
        return sign_in_128_bits(sx, sy, sz);
    }
    std::array<Wide<2>, 3> dz;
    for (int i = 0; i < 3; ++i) dz[i] = dx[i] * dx[i] + dy[i] * dy[i] - excess[i];
    return sign_of_volume(dx, dy, dz);
}

inline Wide<2> widened(Int128 value) {
    const auto bits = static_cast<Uint128>(value);
    return {static_cast<std::uint64_t>(bits), static_cast<std::uint64_t>(bits >> 64)};
}

// By a metric of coefficients below 2^61, from differences below 2^30; 2 where they are not.
inline int sign_of_side_by_metric(const LiftedLattice<ByMetric, 4>& lattice) {
    if (!lattice.fits<1>() || !lattice.form().fits<1>()) return 2;
    std::int64_t m[3], dx[3], dy[3];
    for (int i = 0; i < 3; ++i) {
        m[i] = static_cast<std::int64_t>(lattice.form().at<1>(i).limb[0]);
        dx[i] = static_cast<std::int64_t>((lattice.x<1>(i) - lattice.x<1>(3)).limb[0]);
        dy[i] = static_cast<std::int64_t>((lattice.y<1>(i) - lattice.y<1>(3)).limb[0]);
    }
    if (!std::all_of(dx, dx + 3, is_below_2_to_30) || !std::all_of(dy, dy + 3, is_below_2_to_30))
        return 2;
    Wide<4> det{};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Int128 height = static_cast<Int128>(m[0]) * (dx[i] * dx[i]) +
                              static_cast<Int128>(m[1]) * (2 * dx[i] * dy[i]) +
                              static_cast<Int128>(m[2]) * (dy[i] * dy[i]);
        det = det + widened(height) * widened(dx[j] * dy[k] - dx[k] * dy[j]);
    }
    return det.sign();
}

// The determinant with the rows (x, y, z, 1), expanded along the third column: the height of each
// point times the turn of the three others, of which each is a sum of six products.
template <class Lift>
int sign_of_wide_side(const LiftedLattice<Lift, 4>& lattice) {
    Term<2> product[4][4];  // x of one point, y of another
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) product[i][j] = lattice.part_of_x(i) * lattice.part_of_y(j);
    ExactSum<LiftedLattice<Lift, 4>::factors + 2> det(lattice.width());
    for (int i = 0; i < 4; ++i) {
        const int others[3] = {i == 0 ? 1 : 0, i <= 1 ? 2 : 1, i <= 2 ? 3 : 2};
        for (const auto& part : lattice.height(i)) {
            for (int k = 0; k < 3; ++k) {
                const int p = others[k], q = others[(k + 1) % 3];
                const auto forward = part * product[p][q], back = part * product[q][p];
                if (i % 2 == 0) {
                    det.add(forward);
                    det.subtract(back);
                } else {
                    det.subtract(forward);
                    det.add(back);
                }
            }
        }
    }
    return det.sign();
}

}  // namespace liftmesh
