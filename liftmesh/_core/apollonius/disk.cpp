#include "apollonius/disk.hpp"

#include "apollonius/exactly.hpp"
#include "apollonius/filter.hpp"

namespace liftmesh::apollonius {

namespace {

// Whether it counts as smaller by far more than another. A disk that touches from inside one that
// contains it remains in it.
bool is_later(const Disk& a, const Disk& b) {
    if (a.r != b.r) return a.r < b.r;
    return before_xy({b.x, b.y}, {a.x, a.y});
}

enum class Verdict { conflict, none, tie };

// The sign alone; t may be contained in p, or contain it.
Verdict judged(const Disk& p, const Disk& q, const Disk& r, const Disk& t) {
    const OnLattice<4> on_lattice({&p, &q, &r, &t});
    return on_lattice.visit([&](auto row) {
        const auto to_t = row(3);
        if (!t.is_infinity && sign_of(to_t.power) <= 0)
            return sign_of(to_t.r) > 0 ? Verdict::conflict : Verdict::none;
        const auto to_q = row(1), to_r = row(2);
        const Minors circle(to_q, to_r);
        const int sign = sign_of(distance(circle, to_t), radicand(to_q, to_r, r.is_infinity));
        return sign < 0 ? Verdict::conflict : sign > 0 ? Verdict::none : Verdict::tie;
    });
}

// Of four disks that touch one circle, p, q and r counter-clockwise: which of these is not beside
// t on it.
const Disk& opposite(const Disk& p, const Disk& q, const Disk& r, const Disk& t) {
    const OnLattice<4> on_lattice({&p, &q, &r, &t});
    return *on_lattice.visit([&](auto row) {
        const auto to_q = row(1), to_r = row(2), to_t = row(3);
        const Mixed circle(to_q, to_r);
        const auto root = radicand(to_q, to_r, r.is_infinity);
        if (sign_of(turn(circle, Mixed(to_q, to_t)), root) <= 0) return &r;
        return sign_of(turn(circle, Mixed(to_t, to_r)), root) <= 0 ? &q : &p;
    });
}

}  // namespace

bool Signs::contains(const Disk& a, const Disk& b) const {
    if (a.is_infinity || b.is_infinity || a.r < b.r) return false;
    if (filters_) {
        const Bounded row(a, b);
        if (std::fabs(row.power) > 8 * unit * row.square) return row.power < 0;
    }
    const OnLattice<2> on_lattice({&a, &b});
    return on_lattice.visit([](auto row) { return sign_of(row(1).power) <= 0; });
}

bool Signs::conflicts(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const {
    if (p.is_infinity) return conflicts(q, r, p, t);
    if (q.is_infinity) return conflicts(r, p, q, t);
    if (filters_) {
        const BoundedCircle circle(Bounded(p, q), Bounded(p, r), r.is_infinity);
        if (const int sign = filtered_distance(circle, Bounded(p, t)); sign != 0) return sign < 0;
    }
    const Verdict verdict = judged(p, q, r, t);
    return verdict == Verdict::tie ? breaks_tie(p, q, r, t) : verdict == Verdict::conflict;
}

bool Signs::breaks_tie(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const {
    if (t.is_infinity) return true;
    if (contains(q, t) || contains(r, t)) return false;
    if (contains(t, q) || contains(t, r)) return true;
    const Disk& away = opposite(p, q, r, t);
    if (r.is_infinity) return away.is_infinity;
    const Disk& last = is_later(p, q) ? (is_later(p, r) ? p : r) : (is_later(q, r) ? q : r);
    return !is_later(t, last) && !(last == away);
}

bool Signs::within_edge(const Disk& p, const Disk& q, const Disk& r, const Disk& s,
                        const Disk& t) const {
    if (p.is_infinity) return within_edge(q, p, s, r, t);
    if (conflicts(p, q, t, r) || conflicts(q, p, t, r)) return false;
    if (r == s) return true;
    if (conflicts(p, q, t, s) || conflicts(q, p, t, s)) return false;
    if (conflicts(q, p, r, s) || conflicts(p, q, s, r)) return true;
    return in_order(p, q, s, t, r);
}

int Signs::distance_from(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const {
    if (p.is_infinity) return distance_from(q, r, p, t);
    if (q.is_infinity) return distance_from(r, p, q, t);
    const Verdict verdict = judged(p, q, r, t);
    return verdict == Verdict::tie ? 0 : verdict == Verdict::conflict ? -1 : 1;
}

bool Signs::touches_between(const Disk& p, const Disk& q, const Disk& r, const Disk& t) const {
    if (p.is_infinity) return &opposite(q, r, p, t) == &r;
    if (q.is_infinity) return &opposite(r, p, q, t) == &r;
    return &opposite(p, q, r, t) == &r;
}

bool Signs::reaches_beyond(const Disk& p, const Disk& d) const {
    const OnLattice<2> on_lattice({&p, &d});
    return on_lattice.visit([](auto row) {
        const auto to_d = row(1);
        const int sign = sign_of(to_d.x + to_d.r);
        return (sign != 0 ? sign : sign_of(to_d.y)) > 0;
    });
}

bool Signs::is_between(const Disk& p, const Disk& s, const Disk& r) const {
    const OnLattice<4> on_lattice({&p, &s, &r, &infinity});
    return on_lattice.visit([](auto row) {
        const auto distant = row(3);
        const auto one = distant.power, none = distant.x;
        const Middle first(Mixed(row(1), distant)), last(Mixed(row(2), distant));
        const Middle right(none - one, none, one);  // the negative, as the others are
        return sign_of(orientation(first, right, last)) > 0;
    });
}

bool Signs::in_order(const Disk& p, const Disk& q, const Disk& s, const Disk& t,
                     const Disk& r) const {
    const OnLattice<5> on_lattice({&p, &q, &s, &t, &r}, false);
    return on_lattice.visit([&](auto row) {
        const auto to_q = row(1);
        const auto middle = [&](std::size_t i) { return Middle(Mixed(row(i), to_q)); };
        return sign_of(orientation(middle(2), middle(3), middle(4))) > 0;
    });
}

Circle touching(const Disk& p, const Disk& q, const Disk& r) {
    if (p.is_infinity) return touching(q, r, p);
    if (q.is_infinity) return touching(r, p, q);
    const Bounded to_q(p, q), to_r(p, r);
    const Minors<double> m(to_q, to_r);
    const double x = q.x - r.x, y = q.y - r.y, more = q.r - r.r;
    const double radicand = to_q.power * (r.is_infinity ? 1 : to_r.power * power_of(x, y, more));
    const double root = std::sqrt(std::fmax(radicand, 0));
    const double along_x = -m.xp * m.rp - m.yp * root, along_y = -m.yp * m.rp + m.xp * root;
    if (r.is_infinity) return {along_x, along_y, 0};
    const double twice = 2 * (m.xp * m.xr + m.yp * m.yr + m.xy * root);
    const double all = m.xp * m.xp + m.yp * m.yp;
    return {p.x + along_x / twice, p.y + along_y / twice, all / twice - p.r};
}

namespace {

// Where both parts would cancel, from the product with the conjugate, which is an integer.
Rounded rounded(const Surd<Integer>& s, const Integer& radicand) {
    const Rounded even(s.even), odd = Rounded(s.odd) * Rounded(radicand).root();
    if (s.even.sign() * s.odd.sign() >= 0) return even + odd;
    return Rounded(s.even * s.even - s.odd * s.odd * radicand) / (even - odd);
}

Circle exactly_touching(const Disk& p, const Disk& q, const Disk& r) {
    const OnLattice<3> lattice({&p, &q, &r});
    const Relative<Integer> to_q = lattice.long_row(1), to_r = lattice.long_row(2);
    const Minors<Integer> m(to_q, to_r);
    const Integer none(0, 0), square = radicand(to_q, to_r, false);
    const auto value = [&](const Integer& even, const Integer& odd) {
        return rounded(Surd<Integer>{even, odd}, square);
    };
    const Rounded twice = Rounded(2) * value(m.xp * m.xr + m.yp * m.yr, m.xy);
    const auto along = [&](const Rounded& part) {
        return (part / twice).times(lattice.exponent());
    };
    return {p.x + along(value(none - m.xp * m.rp, none - m.yp)),
            p.y + along(value(none - m.yp * m.rp, m.xp)),
            along(Rounded(m.xp * m.xp + m.yp * m.yp)) - p.r};
}

}  // namespace

Circle surely_touching(const Disk& p, const Disk& q, const Disk& r) {
    constexpr double enough = 0x1p-20;
    const BoundedCircle m(Bounded(p, q), Bounded(p, r), false);
    const double size = m.of_two * (2 * m.of_three + m.root);
    const bool is_sure =
        m.is_sure && std::fabs(m.xp * m.xr + m.yp * m.yr + m.xy * m.root) > enough * size;
    return is_sure ? touching(p, q, r) : exactly_touching(p, q, r);
}

}  // namespace liftmesh::apollonius
