// The polynomials whose signs decide about circles that touch three disks.
//
// Let p be one of three disks, and x, y, r what another has more than p: of its centre, and of its
// radius. With P = x^2 + y^2 - r^2, which is positive unless one of the two disks contains the
// other, a disk touches the circle of centre v about which p is touched too, if
//
//     x X + y Y + r = P S,   with (X, Y) = (v - p) / |v - p| and S = 1 / (2 |v - p|);
//
// a larger left side means that the disk is nearer to v than p: a conflict. Two disks q and r give
// two equations, so (X, Y) is where a line meets the unit circle. With the minors of the two rows
// (x, y, r, P), named after their columns, of the two solutions that with p, q, r
// counter-clockwise about v is
//
//     X N = -xp rp - yp root,   Y N = -yp rp + xp root,   S N = xp xr + yp yr + xy root,
//     N = xp^2 + yp^2,          root^2 = N - rp^2 = P(p, q) P(p, r) P(q, r).
//
// A fourth disk t conflicts with it if
//
//     xp xrp + yp yrp + xyp root < 0,   with the minors of the three rows q, r and t.
//
// Infinity is the row (0, 0, 0, 1): as r, the circle is a tangent line of p and q; as t, a negative
// sign means that no such circle is finite. (M. Karavelas and M. Yvinec, "Dynamic additively
// weighted Voronoi diagrams in 2D", ESA 2002, for the diagram and what is to be decided; J. Emiris
// and M. Karavelas, "The predicates of the Apollonius diagram", Comput. Geom. 33 (2006), for
// predicates by inversion.)
#pragma once

namespace liftmesh::apollonius {

// What a disk has more than the disk p, and its power P with respect to it.
template <class Number>
struct Relative {
    Number x, y, r, power;
};

template <class Number>
Number power_of(const Number& x, const Number& y, const Number& r) {
    return x * x + y * y - r * r;
}

// The minors of two rows that have the column P.
template <class Number>
struct Mixed {
    Number xp, yp, rp;

    Mixed(const Relative<Number>& q, const Relative<Number>& r)
        : xp(q.x * r.power - r.x * q.power),
          yp(q.y * r.power - r.y * q.power),
          rp(q.r * r.power - r.r * q.power) {}
};

// All minors of two rows that matter.
template <class Number>
struct Minors : Mixed<Number> {
    Number xy, xr, yr;

    Minors(const Relative<Number>& q, const Relative<Number>& r)
        : Mixed<Number>(q, r),
          xy(q.x * r.y - r.x * q.y),
          xr(q.x * r.r - r.x * q.r),
          yr(q.y * r.r - r.y * q.r) {}
};

// even + odd * root.
template <class Number>
struct Surd {
    Number even, odd;
};

// Negative if t conflicts with the circle of the minors.
template <class Number>
Surd<Number> distance(const Minors<Number>& m, const Relative<Number>& t) {
    const Number xyp = t.x * m.yp - t.y * m.xp + t.power * m.xy;
    const Number xrp = t.x * m.rp - t.r * m.xp + t.power * m.xr;
    const Number yrp = t.y * m.rp - t.r * m.yp + t.power * m.yr;
    return {m.xp * xrp + m.yp * yrp, xyp};
}

// Positive if p, i, j, which all touch the circle, do so counter-clockwise.
template <class Number>
Surd<Number> turn(const Mixed<Number>& circle, const Mixed<Number>& ij) {
    return {circle.rp * (circle.xp * ij.yp - circle.yp * ij.xp),
            circle.xp * ij.xp + circle.yp * ij.yp};
}

// The middle of the chord that a disk, of which these are the minors with q, cuts off from the
// circle of all (X, Y): homogeneous coordinates.
template <class Number>
struct Middle {
    Number x, y, w;

    explicit Middle(const Mixed<Number>& m)
        : x(m.rp * m.xp), y(m.rp * m.yp), w(m.xp * m.xp + m.yp * m.yp) {}
    Middle(const Number& own_x, const Number& own_y, const Number& own_w)
        : x(own_x), y(own_y), w(own_w) {}
};

// The determinant of three middles: the negative of each is (x, y) / w, which changes no sign.
template <class Number>
Number orientation(const Middle<Number>& a, const Middle<Number>& b, const Middle<Number>& c) {
    return a.w * (b.x * c.y - c.x * b.y) - b.w * (a.x * c.y - c.x * a.y) +
           c.w * (a.x * b.y - b.x * a.y);
}

}  // namespace liftmesh::apollonius
