#include "surface/common_part.hpp"

namespace liftmesh {

namespace {

template <class Real>
Real exactly(double a) {
    if constexpr (std::is_same_v<Real, double>)
        return a;
    else
        return {a, 0};
}

template <class Real>
Real difference(double a, double b) {
    if constexpr (std::is_same_v<Real, double>)
        return a - b;
    else
        return exact_difference(a, b);
}

template <class Real>
bool is_before(const Real& a, const Real& b) {
    return as_double(a - b) < 0;
}

template <class Real>
bool is_positive(const Real& a) {
    return as_double(a) > 0;
}

// In an order in which no two sides are alike that cross.
auto length(Point tail, Point head) {
    const double dx = head.x - tail.x, dy = head.y - tail.y;
    return std::tuple(dx * dx + dy * dy, std::fabs(dx), std::fabs(dy), dx * dy > 0);
}

// Of a tetrahedron: what is beyond zero of a prism, where one corner alone is on its side.
template <class Real>
Real tip(const Real& area, const Real& alone, const Real& near, const Real& far) {
    return area * (alone / exactly<Real>(3)) * (alone / (alone - near)) * (alone / (alone - far));
}

// The sum of two products of double words.
class Expansion {
 public:
    void add(const Long& a, const Long& b) {
        for (const double p : {a.high, a.low})
            for (const double q : {b.high, b.low}) {
                const Long product = exact_product(p, q);
                terms_[count_++] = product.low;
                terms_[count_++] = product.high;
            }
    }

    Long sum() {
        for (int pass = 0; pass < 3; ++pass)
            for (std::size_t i = 1; i < most; ++i) {
                const Long sum = exact_sum(terms_[i], terms_[i - 1]);
                terms_[i] = sum.high;
                terms_[i - 1] = sum.low;
            }
        Long total{terms_[most - 1], 0};
        for (std::size_t i = most - 1; i-- > 0;) total = terms_[i] + total;
        return total;
    }

 private:
    static constexpr std::size_t most = 16;
    std::array<double, most> terms_;
    std::size_t count_ = 0;
};

}  // namespace

// Where products nearly cancel, their exact parts are added up in four times the precision of
// doubles (SumK of Ogita, Rump and Oishi, "Accurate sum and dot product", 2005).
Long precise(const Turn& turn, Point a, Point b, Point c) {
    constexpr double enough = 0x1p-10;
    const Long ax = exact_difference(a.x, c.x), ay = exact_difference(a.y, c.y),
               bx = exact_difference(b.x, c.x), by = exact_difference(b.y, c.y);
    const Long left = ax * by, right = ay * bx, value = left - right;
    if (std::fabs(value.high) > enough * (std::fabs(left.high) + std::fabs(right.high)))
        return value;
    Expansion terms;
    terms.add(ax, by);
    terms.add(-ay, bx);
    const Long sum = terms.sum();
    return (sum.high > 0) == (turn.value > 0) ? sum : Long{turn.value, 0};  // below all doubles
}

template <class Real>
Point CommonPart<Real>::origin_of(const FacePair& pair) {
    const double extents[2] = {pair.face(0).extent, pair.face(1).extent};
    const Point least[2] = {pair.face(0).at(0), pair.face(1).at(0)};
    extent_ = std::min(extents[0], extents[1]);
    if (extents[0] != extents[1]) return least[extents[1] < extents[0]];
    return least[before_xy(least[1], least[0])];
}

template <class Real>
Real CommonPart<Real>::turned(std::size_t face, std::size_t side, std::size_t corner) const {
    constexpr double share = 0x1p-3;
    const Turn& turn = pair_.turn_about(face, side, corner);
    if (turn.value == 0) return exactly<Real>(0);
    if constexpr (std::is_same_v<Real, double>)
        if (std::fabs(turn.value) > share * turn.size) return turn.value;
    const Long value = precise(turn, pair_.face(face).at(tail_of(side)),
                               pair_.face(face).at(head_of(side)), pair_.face(1 - face).at(corner));
    if constexpr (std::is_same_v<Real, double>)
        return value.high;
    else
        return value;
}

template <class Real>
typename CommonPart<Real>::Corner CommonPart<Real>::at_corner(std::size_t face, std::size_t k) {
    const SurfaceCorner& corner = pair_.face(face).corners[k];
    Real sum = exactly<Real>(0), weighted = sum;
    double most = 0;
    std::size_t used = 0, last = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Real weight = turned(1 - face, i, k);
        if (as_double(weight) == 0) continue;
        const Real rise = difference<Real>(pair_.face(1 - face).corners[i].height, corner.height);
        most = std::max(most, std::fabs(as_double(rise)));
        sum = sum + weight;
        weighted = weighted + weight * rise;
        last = i;
        ++used;
    }
    if (used > 1) found_.steepness = std::max(found_.steepness, most);
    const Real rise =
        used > 1 ? weighted / sum
                 : difference<Real>(pair_.face(1 - face).corners[last].height, corner.height);
    return {difference<Real>(corner.at.x, origin_.x), difference<Real>(corner.at.y, origin_.y),
            face == 0 ? rise : -rise};
}

// The four turns are the distances of the ends of each side from the other, and both pairs add up
// to the same. So surfaces on one lattice that meet have no rise there, not even a rounded one.
template <class Real>
typename CommonPart<Real>::Corner CommonPart<Real>::at_crossing(std::size_t side,
                                                                std::size_t other) {
    const SurfaceCorner &p = pair_.face(0).corners[tail_of(side)],
                        &q = pair_.face(0).corners[head_of(side)],
                        &r = pair_.face(1).corners[tail_of(other)],
                        &s = pair_.face(1).corners[head_of(other)];
    const auto distance = [this](std::size_t face, std::size_t about, std::size_t end) {
        const Real found = turned(face, about, end);
        return is_positive(found) ? found : -found;
    };
    const Real from_p = distance(1, other, tail_of(side)),
               from_r = distance(0, side, tail_of(other));
    const Real along = from_p + distance(1, other, head_of(side)),
               across = from_r + distance(0, side, head_of(other));
    const Real rise_first = difference<Real>(q.height, p.height),
               rise_second = difference<Real>(s.height, r.height),
               apart = difference<Real>(r.height, p.height);
    found_.steepness = std::max({found_.steepness, std::fabs(as_double(rise_first)),
                                 std::fabs(as_double(rise_second)), std::fabs(as_double(apart))});
    const Real twice = exactly<Real>(2) * (from_r * rise_second - from_p * rise_first);
    const Real rise = apart + twice / (along + across);
    const auto divided = [&](Point tail, Point head, const Real& share) -> Corner {
        return {difference<Real>(tail.x, origin_.x) + share * difference<Real>(head.x, tail.x),
                difference<Real>(tail.y, origin_.y) + share * difference<Real>(head.y, tail.y),
                rise};
    };
    return length(p.at, q.at) < length(r.at, s.at) ? divided(p.at, q.at, from_p / along)
                                                   : divided(r.at, s.at, from_r / across);
}

template <class Real>
Real CommonPart<Real>::cross(const Corner& o, const Corner& p, const Corner& q) {
    return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
}

// Keeps what is to the left of a line.
template <class Real>
typename CommonPart<Real>::Polygon CommonPart<Real>::clipped(const Polygon& polygon, Point tail,
                                                             Point head) {
    const auto placed = [this](Point p) -> Corner {
        return {difference<Real>(p.x, origin_.x), difference<Real>(p.y, origin_.y), Real{}};
    };
    const auto size = [](const Corner& p) {
        return std::max(std::fabs(as_double(p.x)), std::fabs(as_double(p.y)));
    };
    const Corner from = placed(tail), to = placed(head);
    Polygon left;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Corner &p = polygon.corners[i], &q = polygon.corners[(i + 1) % polygon.count];
        const Real at_p = cross(from, to, p), at_q = cross(from, to, q);
        if (as_double(at_p) >= 0)
            left.add(p);
        else
            reach_ = std::max({reach_, size(from), size(to)});
        if ((as_double(at_p) > 0 && as_double(at_q) < 0) ||
            (as_double(at_p) < 0 && as_double(at_q) > 0)) {
            const Real share = at_p / (at_p - at_q);
            left.add({p.x + share * (q.x - p.x), p.y + share * (q.y - p.y),
                      p.rise + share * (q.rise - p.rise)});
        }
    }
    return left;
}

template <class Real>
typename CommonPart<Real>::Polygon CommonPart<Real>::polygon() {
    const FacePair::Outline outline = pair_.outline();
    Polygon polygon;
    for (std::size_t i = 0; i < outline.count; ++i) {
        const FacePair::Corner& each = outline.corners[i];
        polygon.add(each.is_crossing ? at_crossing(each.k, each.other)
                                     : at_corner(each.face, each.k));
    }
    return polygon;
}

// Thin faces have corners that rounding puts in one place.
template <class Real>
void CommonPart<Real>::begin_at_least(Polygon& polygon) {
    const auto is_less = [](const Corner& p, const Corner& q) {
        const double x = as_double(p.x - q.x), y = as_double(p.y - q.y);
        if (x != 0) return x < 0;
        return y != 0 ? y < 0 : std::fabs(as_double(p.rise)) < std::fabs(as_double(q.rise));
    };
    Corner* const corners = polygon.corners.data();
    std::rotate(corners, std::min_element(corners, corners + polygon.count, is_less),
                corners + polygon.count);
}

template <class Real>
Volumes CommonPart<Real>::measure(const Triangle* part) {
    Polygon common = polygon();
    for (std::size_t k = 0; part && k < 3 && common.count > 2; ++k)
        common = clipped(common, (*part)[k], (*part)[after(k)]);
    if (common.count < 3) return {};
    begin_at_least(common);
    Real above{}, below{}, area{};
    for (std::size_t i = 0; i < common.count; ++i) {
        const Corner &apex = common.corners[0], &p = common.corners[i];
        found_.rise = std::max(found_.rise, std::fabs(as_double(p.rise)));
        if (i + 1 == common.count) break;
        const Corner& q = common.corners[i + 1];
        const Real twice = cross(apex, p, q);
        if (!is_positive(twice)) continue;
        area = area + twice;
        add_prism(twice, {apex.rise, p.rise, q.rise}, above, below);
    }
    found_.area = as_double(area) / 2;
    found_.above = as_double(above) / 2;
    found_.below = as_double(below) / 2;
    found_.rounding = extent_ * std::max(extent_, reach_);
    return found_;
}

template <class Real>
void CommonPart<Real>::add_prism(Real area, std::array<Real, 3> rise, Real& above, Real& below) {
    const auto order = [&rise](std::size_t i, std::size_t j) {
        if (is_before(rise[j], rise[i])) std::swap(rise[i], rise[j]);
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    const auto& [low, middle, high] = rise;
    const Real whole = area * ((middle + (low + high)) / exactly<Real>(3));
    const Real zero{};
    const auto rest = [&zero](const Real& of) { return is_positive(of) ? of : zero; };
    if (as_double(low) >= 0) {
        above = above + whole;
    } else if (as_double(high) <= 0) {
        below = below - whole;
    } else {
        const double turning = as_double(middle);
        const Real under = turning >= 0 ? tip(area, -low, -middle, -high) : zero;
        const Real over = turning <= 0 ? tip(area, high, middle, low) : zero;
        below = below + (turning >= 0 ? under : rest(over - whole));
        above = above + (turning <= 0 ? over : rest(whole + under));
    }
}

template class CommonPart<double>;
template class CommonPart<Long>;

}  // namespace liftmesh
