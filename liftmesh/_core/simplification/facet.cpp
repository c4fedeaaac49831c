#include "simplification/facet.hpp"

#include "predicates/exact_sum.hpp"
#include "predicates/lattice.hpp"

namespace liftmesh::simplification {

// With e = 2^-53: differences have a relative error of e. The determinant d, and the numerators of
// the slopes, are sums of two products with an error of at most 4 e times the sum of their
// magnitudes. So a slope s is off by at most (4 e N + |s| 4 e D) / (|d| - 4 e D) + e |s|, where N
// and D are those sums, and a distance by that times the extent of the triangle along both axes,
// and by few roundings of its terms. Factors of 2 cover what is of higher order; 1e-300 covers the
// underflow of products, and a few of the least steps that of slopes, which extents multiply.
// Overflow leaves no bound: then every sample is decided exactly.
Facet::Facet(Sample a, Sample b, Sample c, const Tolerance& tolerance)
    : is_exact_(tolerance.is_exact), tolerance_(tolerance.value) {
    if (before_xy(b.point, a.point) && before_xy(b.point, c.point))
        std::tie(a, b, c) = std::tuple(b, c, a);
    else if (before_xy(c.point, a.point))
        std::tie(a, b, c) = std::tuple(c, a, b);
    corners_[0] = a;
    corners_[1] = b;
    corners_[2] = c;
    constexpr double e = 0x1p-53, steps = 0x1p-1070,
                     infinity = std::numeric_limits<double>::infinity();
    const double bx = b.point.x - a.point.x, by = b.point.y - a.point.y, bz = b.height - a.height;
    const double cx = c.point.x - a.point.x, cy = c.point.y - a.point.y, cz = c.height - a.height;
    const double det = bx * cy - by * cx;
    det_ = det;
    rise_x_ = bz * cy - cz * by;
    rise_y_ = bx * cz - cx * bz;
    slope_x_ = rise_x_ / det;
    slope_y_ = rise_y_ / det;
    const double of_det = 4 * e * (std::fabs(bx * cy) + std::fabs(by * cx)) + 1e-300;
    const double of_x = 4 * e * (std::fabs(bz * cy) + std::fabs(cz * by)) + 1e-300;
    const double of_y = 4 * e * (std::fabs(bx * cz) + std::fabs(cx * bz)) + 1e-300;
    const double sure = std::fabs(det) - of_det;
    const double width = std::max(std::fabs(bx), std::fabs(cx));
    const double length = std::max(std::fabs(by), std::fabs(cy));
    const double sx = std::fabs(slope_x_), sy = std::fabs(slope_y_);
    const double of_slopes = width * ((of_x + sx * of_det) / sure + 8 * e * sx + steps) +
                             length * ((of_y + sy * of_det) / sure + 8 * e * sy + steps);
    // A distance near the tolerance: one far from it need not be exact.
    const double error = 2 * of_slopes + 8 * e * tolerance_ + 1e-300;
    const bool is_bounded = sure > of_det && error < infinity;
    surely_within_ = is_bounded ? tolerance_ - error : -1;
    surely_beyond_ = is_bounded ? tolerance_ + error : infinity;
}

namespace {

// Adds a product of a height and the turn of three points, or subtracts it.
class Expansion {
 public:
    Expansion(const PlanarLattice<4>& planar, const Lattice<5>& heights)
        : planar_(planar), heights_(heights), sum_(std::max(planar.width(), heights.width())) {}

    void add(int height, bool negative, int i, int j, int k) {
        const int points[3] = {i, j, k};
        const auto z = one_factor(heights_.part(height));
        for (int from = 0; from < 3; ++from) {
            const int to = points[(from + 1) % 3], at = points[from];
            accumulate(z * (planar_.part_of_x(at) * planar_.part_of_y(to)), negative);
            accumulate(z * (planar_.part_of_y(at) * planar_.part_of_x(to)), !negative);
        }
    }
    int sign() const { return sum_.sign(); }

 private:
    void accumulate(const Term<3>& term, bool negative) {
        negative ? sum_.subtract(term) : sum_.add(term);
    }

    const PlanarLattice<4>& planar_;
    const Lattice<5>& heights_;
    ExactSum<3> sum_;
};

}  // namespace

// Times the turn of the triangle, the distance is z_q turn(a, b, c) - z_a turn(q, b, c) -
// z_b turn(a, q, c) - z_c turn(a, b, q): compared with the tolerance times it, on either side.
bool exceeds_exactly(const Sample (&corners)[3], const Sample& sample, double tolerance) {
    const PlanarLattice<4> planar(
        {corners[0].point, corners[1].point, corners[2].point, sample.point});
    const Lattice<5> heights(
        {corners[0].height, corners[1].height, corners[2].height, sample.height, tolerance});
    for (const bool is_below : {false, true}) {
        Expansion excess(planar, heights);
        excess.add(3, is_below, 0, 1, 2);
        excess.add(0, !is_below, 3, 1, 2);
        excess.add(1, !is_below, 0, 3, 2);
        excess.add(2, !is_below, 0, 1, 3);
        excess.add(4, true, 0, 1, 2);
        if (excess.sign() > 0) return true;
    }
    return false;
}

}  // namespace liftmesh::simplification
