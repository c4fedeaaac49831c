// Points in space: tetrahedra, predicates, location and the verifier, judged by integers of any
// length.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "encodings.hpp"
#include "exact.hpp"
#include "predicates/insphere.hpp"
#include "predicates/scale.hpp"
#include "targets.hpp"
#include "tetrahedra/locate.hpp"
#include "tetrahedra/tetrahedra.hpp"
#include "verify/tetrahedra.hpp"

namespace fuzzing {

namespace {

using liftmesh::Input;
using liftmesh::SpaceVerdict;
using liftmesh::Status;
using liftmesh::Tetrahedra;
using liftmesh::Threads;
using liftmesh::Trust;

constexpr std::size_t most_points = 40, most_wide_points = 10, questions = 24;
constexpr std::uint8_t asks_for_tiles = 255;

struct SpaceCase {
    std::vector<SpacePoint> points;
    bool skips;
    unsigned threads;
    Dice dice;

    std::size_t rows() const { return points.size(); }
    Input input() const {
        return {reinterpret_cast<const std::byte*>(points.data()), points.size(),
                sizeof(SpacePoint), sizeof(double), false};
    }
    bool is_finite(std::size_t row) const {
        const SpacePoint& p = points[row];
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    }
};

// Whether signs take the longest integers.
bool are_wide(const SpaceCase& c) {
    liftmesh::Range range;
    for (std::size_t row = 0; row < c.rows(); ++row)
        if (c.is_finite(row)) range.add(c.points[row].planar()), range.add({c.points[row].z, 0});
    return !liftmesh::Scale(range, Trust::least_exponent).guard.vouches();
}

// The third coordinate is one of the next point, or thousands of them make layers.
SpaceCase space_case(Bytes bytes) {
    const std::size_t size = bytes.size();
    const std::uint8_t encoded = bytes.byte(), flags = bytes.byte();
    SpaceCase c{{}, (flags & 1) != 0, 1 + (flags >> 1 & 3u), Dice(size + flags)};
    if (encoded == asks_for_tiles && flags == asks_for_tiles) {
        for (const Point p : tiled(bytes))
            c.points.push_back({p.x + 0.0, p.y + 0.0, static_cast<double>(c.dice.below(9))});
    } else {
        const Encoding next = encoding(encoded, bytes);
        while (bytes.left() && c.points.size() < most_points) {
            const Point p = next(bytes), q = next(bytes);
            c.points.push_back({p.x + 0.0, p.y + 0.0, q.x + 0.0});
        }
    }
    if (are_wide(c) && c.rows() > most_wide_points) c.points.resize(most_wide_points);
    return c;
}

Tetrahedra run(const SpaceCase& c, unsigned threads, std::size_t patience = ~std::size_t{0}) {
    Impatient interrupt(patience);
    return liftmesh::tetrahedralize(c.input(), c.skips, c.rows(), {threads, false}, interrupt);
}

SpaceVerdict verdict_on(const SpaceCase& c, const Corners& corners) {
    Impatient interrupt;
    return liftmesh::verify_tetrahedra(c.input(), corners.data(), corners.size() / 4, c.skips,
                                       {c.threads, false}, interrupt);
}

class SpaceJudge {
 public:
    SpaceJudge(SpaceCase& c, const Tetrahedra& found)
        : c_(c),
          found_(found),
          corners_(found.simplices.get(), found.simplices.get() + 4 * found.count) {}

    void check_tetrahedra() const {
        std::vector<bool> is_vertex(c_.rows());
        std::size_t rim = 0;
        for (std::size_t place = 0; place < corners_.size(); ++place) {
            is_vertex[static_cast<std::size_t>(corners_[place])] = true;
            if (place % 4 == 0) demand(volume(place, corner(place)) > 0, "a flat tetrahedron");
            if (found_.neighbors[place] < 0)
                ++rim, check_rim(place);
            else
                check_facet(place, 4 * static_cast<std::size_t>(found_.neighbors[place]));
        }
        demand(rim == found_.hull.size(), "a facet of the hull is lost");
        const auto vertices = std::count(is_vertex.begin(), is_vertex.end(), true);
        demand(static_cast<std::size_t>(vertices) == found_.distinct, "a position is not a vertex");
        demand(found_.distinct + found_.duplicates.size() + found_.skipped.size() == c_.rows(),
               "a row is lost");
    }

    void check_verdicts() const {
        demand(!verdict_on(c_, corners_).flaws.any(), "the verifier finds flaws");
        Corners damaged = corners_;
        const std::size_t t = 4 * c_.dice.below(found_.count), k = t + c_.dice.below(4);
        const auto at = [](Corners& all, std::size_t i) {
            return all.begin() + static_cast<std::ptrdiff_t>(i);
        };
        switch (c_.dice.below(4)) {
            case 0:
                damaged.erase(at(damaged, t), at(damaged, t + 4));
                break;
            case 1:
                damaged.insert(damaged.end(), at(damaged, t), at(damaged, t + 4));
                break;
            case 2:
                std::swap(damaged[t], damaged[t + 1]);
                break;
            default:
                if (c_.points[static_cast<std::size_t>(damaged[k])] == c_.points[0]) return;
                damaged[k] = 0;
        }
        demand(verdict_on(c_, damaged).flaws.any(), "the verifier accepts damaged tetrahedra");
    }

    void check_location() const {
        std::vector<SpacePoint> queries;
        for (std::size_t i = 0; i < questions; ++i) {
            const SpacePoint &p = some(), &q = some();
            queries.push_back({p.x, q.y, i % 2 == 0 ? p.z : q.z});
        }
        std::vector<std::int32_t> at(queries.size());
        Impatient interrupt;
        liftmesh::SpaceLocator({c_.points.data(), c_.rows(), found_.simplices.get(),
                                found_.neighbors.get(), found_.count})
            .find(queries.data(), queries.size(), interrupt, at.data());
        for (std::size_t i = 0; i < queries.size(); ++i)
            demand(at[i] == first_around(queries[i]), "a point is located elsewhere");
    }

    void check_signs() const {
        for (std::size_t i = 0; i < questions; ++i) {
            const SpacePoint five[5] = {some(), some(), some(), some(), some()};
            const auto& [a, b, c, d, e] = five;
            const int whole = -orient3d(a, b, c, d, false);
            demand(liftmesh::volume_sign(a, b, c, d, {}) == whole, "volume_sign is wrong");
            demand(liftmesh::orient3d_exact(a, b, c, d) == -whole, "orient3d is wrong");
            demand(liftmesh::insphere_exact(five, {}) == insphere(five, false),
                   "insphere is wrong");
            const bool is_told = whole != 0 && std::find(five, five + 4, e) == five + 4;
            demand(liftmesh::insphere_canonical_exact(five, {}) ==
                       (is_told ? insphere(five, true) : insphere(five, false)),
                   "the canonical sign of insphere is wrong");
        }
    }

 private:
    const SpacePoint& at(std::int32_t row) const {
        return c_.points[static_cast<std::size_t>(row)];
    }
    const SpacePoint& corner(std::size_t place) const { return at(corners_[place]); }
    const SpacePoint& some() const { return corner(c_.dice.below(corners_.size())); }

    // Of the tetrahedron with the corner at a place replaced.
    int volume(std::size_t place, const SpacePoint& p) const {
        const std::size_t first = place - place % 4;
        std::array<SpacePoint, 4> q = {corner(first), corner(first + 1), corner(first + 2),
                                       corner(first + 3)};
        q[place % 4] = p;
        return -orient3d(q[0], q[1], q[2], q[3], false);
    }

    void check_rim(std::size_t place) const {
        for (std::size_t row = 0; row < c_.rows(); ++row)
            if (c_.is_finite(row))
                demand(volume(place, c_.points[row]) >= 0, "a point is outside of the hull");
    }

    void check_facet(std::size_t place, std::size_t other) const {
        const std::size_t first = place - place % 4;
        std::size_t back = 4, same = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            if (found_.neighbors[other + k] == static_cast<std::int32_t>(place / 4)) back = k;
            same += static_cast<std::size_t>(
                std::count(&corners_[first], &corners_[first] + 4, corners_[other + k]));
        }
        demand(back < 4 && same == 3, "neighbours do not share a facet");
        const SpacePoint five[5] = {corner(first), corner(first + 1), corner(first + 2),
                                    corner(first + 3), corner(other + back)};
        demand(insphere(five, true) < 0, "a facet is not Delaunay, or not canonical");
    }

    std::int32_t first_around(const SpacePoint& p) const {
        for (std::size_t t = 0; t < found_.count; ++t) {
            bool is_inside = true;
            for (std::size_t k = 0; k < 4 && is_inside; ++k) is_inside = volume(4 * t + k, p) >= 0;
            if (is_inside) return static_cast<std::int32_t>(t);
        }
        return -1;
    }

    SpaceCase& c_;
    const Tetrahedra& found_;
    Corners corners_;
};

// All points are in the plane or on the line of the witness.
void check_flat(const SpaceCase& c, const Tetrahedra& found) {
    if (found.status != Status::coplanar) return;
    const auto at = [&](std::size_t i) { return c.points[found.witness[i]]; };
    for (std::size_t row = 0; row < c.rows(); ++row)
        if (c.is_finite(row))
            demand(orient3d(at(0), at(1), at(2), c.points[row], false) == 0,
                   "a point is off the plane of all");
}

bool are_same(const Tetrahedra& a, const Tetrahedra& b) {
    return a.count == b.count && a.hull == b.hull &&
           std::equal(a.simplices.get(), a.simplices.get() + 4 * a.count, b.simplices.get()) &&
           std::equal(a.neighbors.get(), a.neighbors.get() + 4 * a.count, b.neighbors.get());
}

}  // namespace

void check_space(Bytes bytes) {
    SpaceCase c = space_case(bytes);
    const Tetrahedra found = run(c, 1);
    check_flat(c, found);
    if (found.status != Status::ok) return;
    SpaceJudge judge(c, found);
    judge.check_verdicts();
    const Tetrahedra impatient = run(c, c.threads, 1 + c.dice.below(40));
    demand(impatient.status == Status::interrupted || are_same(impatient, found),
           "threads, or another order, change the tetrahedra");
    if (c.rows() > most_points) return;
    judge.check_tetrahedra();
    judge.check_location();
    judge.check_signs();
}

}  // namespace fuzzing
