// The geometry of some triangles at a time, two abreast and without branches: which of them surely
// turn counter-clockwise, a lower bound of the cotangent of each angle, and how many cover the
// direction upwards at a corner (`repeated_edges.cpp`).
//
// The angles opposite an edge tell whether it is locally Delaunay: the apex of one triangle lies
// outside the circumcircle of the other where they sum to less than pi, that is where
//
//     cot r + cot s = sin (r + s) / (sin r sin s) > 0.
//
// So the sum of two lower bounds decides nearly every edge: the sign of a sum of two doubles is
// exact. With p and q from a corner to the others, in counter-clockwise order, the cotangent of the
// angle there is (p . q) / (p x q), and p x q is the same at each corner: twice the area.
//
// The bounds. Products and sums of rounded differences have the error of `orient2d`, underflow
// included: the computed area C and a computed product D are off by at most e_C and e_D. So where
// C > 2 e_C the exact area is above C / 2, whatever the coordinates, and
//
//     |p.q / p x q - D / C| <= 2 (e_D + |D / C| e_C) / C.
//
// To round 1 / C, its product with D and the last difference takes 3.1 |D / C| 2^-53, which is
// below 1.1 e_D / C. So 4 (e_D + |D / C| e_C) / C covers all of it. In these quotients nothing
// underflows or overflows where the guard vouches; elsewhere its margin makes each bound minus
// infinity.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

class TriangleBatch {
 public:
    static constexpr std::size_t size = 64;

    void set(std::size_t i, Point a, Point b, Point c) {
        corners_[0].set(i, a);
        corners_[1].set(i, b);
        corners_[2].set(i, c);
    }

    // Measures all of them. Returns how many cover the direction upwards at a corner.
    std::size_t measure(Guard guard) {
        const auto& [a, b, c] = corners_;
        const Pair margin = Pair{} + guard.margin();
        PairBits covering = {};
        for (std::size_t i = 0; i < size / 2; ++i) {
            const Pair px = a.x[i] - c.x[i], py = a.y[i] - c.y[i];
            const Pair qx = b.x[i] - c.x[i], qy = b.y[i] - c.y[i];
            const Pair rx = b.x[i] - a.x[i], ry = b.y[i] - a.y[i];
            const Sum area(px * qy, -(py * qx));
            const Pair inverse = 1 / area.value;
            certain_[i] = area.value > 2 * area.error;
            const auto bound = [&](const Sum& product) {
                const Pair cotangent = product.value * inverse;
                const Pair error = product.error + magnitudes(cotangent) * area.error;
                return cotangent - (4 * error * inverse + margin);
            };
            cotangents_[0][i] = bound({-(px * rx), -(py * ry)});
            cotangents_[1][i] = bound({qx * rx, qy * ry});
            cotangents_[2][i] = bound({px * qx, py * qy});
            covering += (ascends(a, b, i) + ascends(b, c, i) + ascends(c, a, i)) == -2;
        }
        return static_cast<std::size_t>(-(covering[0] + covering[1]));
    }

    // Whether triangle i surely turns counter-clockwise. If so, its bounds hold.
    bool is_certain(std::size_t i) const { return certain_[i / 2][i % 2] != 0; }
    double cotangent(std::size_t i, std::size_t corner) const {
        return cotangents_[corner][i / 2][i % 2];
    }

 private:
    template <class T>
    using Pairs = std::array<T, size / 2>;

    struct Corners {
        Pairs<Pair> x, y;

        void set(std::size_t i, Point p) {
            x[i / 2][i % 2] = p.x;
            y[i / 2][i % 2] = p.y;
        }
    };

    // The sum of two products, and a bound of its error.
    struct Sum {
        Sum(Pair left, Pair right)
            : value(left + right),
              error(orient2d_bound * (magnitudes(left) + magnitudes(right)) + orient2d_underflow) {}
        Pair value, error;
    };

    // As `before_xy`: -1 if so.
    static PairBits ascends(const Corners& p, const Corners& q, std::size_t i) {
        return (p.x[i] < q.x[i]) | ((p.x[i] == q.x[i]) & (p.y[i] < q.y[i]));
    }

    std::array<Corners, 3> corners_ = {};
    std::array<Pairs<Pair>, 3> cotangents_ = {};
    Pairs<PairBits> certain_ = {};
};

}  // namespace liftmesh
