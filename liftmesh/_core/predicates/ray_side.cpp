#include "predicates/ray_side.hpp"

#include "predicates/orient2d.hpp"
#include "predicates/space_lattice.hpp"

namespace liftmesh {

namespace {

// By a power of two, the largest coordinate is near 1. What underflows then is less than any error.
SpacePoint scaled(const SpacePoint& p) {
    const int shift = -std::ilogb(std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}));
    return {std::ldexp(p.x, shift), std::ldexp(p.y, shift), std::ldexp(p.z, shift)};
}

// Within 4 u^2 of the root.
DoubleWord<double> square_root(const DoubleWord<double>& a) {
    const double high = std::sqrt(a.high);
    const DoubleWord<double> product = exact_product(high, high);
    return quick_sum(high, ((a.high - product.high) - product.low + a.low) / (high + high));
}

using WideVector = Vector<DoubleWord<double>>;

WideVector step(const UnitVector& from, const UnitVector& to) {
    return {to.x - from.x, to.y - from.y, to.z - from.z};
}

// In double words, as in doubles: coordinates err by 25 u^2, steps by 53 u^2.
int side_in_double_words(const Ray& a, const Ray& b, const Ray& c, const Ray& d) {
    const UnitVector origin = unit_vector(d.given);
    const WideVector p = step(origin, unit_vector(a.given)), q = step(origin, unit_vector(b.given)),
                     r = step(origin, unit_vector(c.given));
    const double det = -dot(p, cross(q, r)).high;
    const double length = std::max({square(p).high, square(q).high, square(r).high});
    const double error = 400 * 0x1p-106 * length + 0x1p-1000;
    return (det > error) - (-det > error);
}

// --- exact signs --------------------------------------------------------------------------------

// The sign of a + b, from their signs and that of |a| - |b|, which is asked for only if it matters.
template <class Compare>
int sign_of_sum(int a, int b, Compare compare) {
    if (a == 0 || a == b) return b;
    return b == 0 ? a : a * compare();
}

// Of a sqrt(alpha) + b sqrt(beta).
template <int N, int M>
int sign_of_roots(const Wide<N>& a, const Wide<M>& alpha, const Wide<N>& b, const Wide<M>& beta) {
    return sign_of_sum(a.sign(), b.sign(), [&] { return (a * a * alpha - b * b * beta).sign(); });
}

// Of h + k sqrt(m).
template <int N, int M, int L>
int sign_of_root(const Wide<N>& h, const Wide<M>& k, const Wide<L>& m) {
    return sign_of_sum(h.sign(), k.sign(), [&] { return (h * h - k * k * m).sign(); });
}

// The coefficients and squares of the four terms. Coordinates are below 2^(64N - 3), determinants
// below 2^(192N - 6) and squares below 2^(128N - 4).
template <int N>
struct FourRoots {
    Wide<3 * N> factor[4];
    Wide<2 * N> square[4];

    int sign() const {
        const int first = sign_of_roots(factor[0], square[0], factor[1], square[1]);
        const int second = sign_of_roots(factor[2], square[2], factor[3], square[3]);
        return sign_of_sum(first, second, [&] { return sign_of_squares(); });
    }

 private:
    // The square of the sum of the first two terms, minus that of the others: e + f sqrt(ab) +
    // g sqrt(cd). With t for the roots, e^2 - t^2 = h + k sqrt(abcd). The largest square is below
    // 2^(2048N - 54).
    int sign_of_squares() const {
        const Wide<8 * N> e = (term(0) + term(1)) - (term(2) + term(3));
        const Wide<6 * N> f = doubled(factor[0] * factor[1]);
        const Wide<6 * N> g = Wide<6 * N>{} - doubled(factor[2] * factor[3]);
        const Wide<4 * N> ab = square[0] * square[1], cd = square[2] * square[3];
        return sign_of_sum(e.sign(), sign_of_roots(f, ab, g, cd), [&] {
            const Wide<16 * N> h = e * e - f * f * ab - g * g * cd;
            const Wide<12 * N> k = Wide<12 * N>{} - doubled(f * g);
            return sign_of_root(h, k, ab * cd);
        });
    }
    Wide<8 * N> term(int i) const { return factor[i] * factor[i] * square[i]; }

    template <int M>
    static Wide<M> doubled(const Wide<M>& value) {
        return value + value;
    }
};

template <int N, int K>
Vector<Wide<N>> vector_of(const SpaceLattice<K>& lattice, int i) {
    return {lattice.template at<N>(3 * i), lattice.template at<N>(3 * i + 1),
            lattice.template at<N>(3 * i + 2)};
}

int sign_of_four_roots(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                       const SpacePoint& d) {
    const SpaceLattice<4> lattice({a, b, c, d});
    return at_width_of(lattice, [&]<int N>() {
        Vector<Wide<N>> p[4];
        FourRoots<N> roots;
        for (int i = 0; i < 4; ++i) p[i] = vector_of<N>(lattice, i);
        for (int i = 0; i < 4; ++i) {
            const auto& [u, v, w] = std::tie(p[i == 0], p[i < 2 ? 2 : 1], p[i < 3 ? 3 : 2]);
            const Wide<3 * N> det = dot(u, cross(v, w));
            roots.factor[i] = i % 2 == 0 ? det : Wide<3 * N>{} - det;
            roots.square[i] = square(p[i]);
        }
        return roots.sign();
    });
}

// --- ties ---------------------------------------------------------------------------------------

int determinant_sign(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) {
    return orient3d_exact(a, b, c, {0, 0, 0});
}

// The turn from one ray to another, seen along an axis.
int turn(const SpacePoint& p, const SpacePoint& q, int axis) {
    const auto flat = [axis](const SpacePoint& r) {
        return axis == 2 ? Point{r.x, r.y} : axis == 1 ? Point{r.z, r.x} : Point{r.y, r.z};
    };
    return orient2d({0, 0}, flat(p), flat(q));
}

// Three distinct rays of one plane turn counter-clockwise if two of their angles are less than pi.
int cyclic_turn(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c, int axis) {
    const int lefts = (turn(a, b, axis) > 0) + (turn(b, c, axis) > 0) + (turn(c, a, axis) > 0);
    return lefts >= 2 ? 1 : -1;
}

// The sign once the i-th ray is moved: inwards, or from the plane of all along an axis.
int perturbed_side(const SpacePoint (&p)[4], int i, int axis) {
    const SpacePoint& u = p[i == 0];
    const SpacePoint& v = p[i < 2 ? 2 : 1];
    const SpacePoint& w = p[i < 3 ? 3 : 2];
    const int sign = axis < 0 ? determinant_sign(u, v, w) : -cyclic_turn(u, v, w, axis);
    return i % 2 == 0 ? sign : -sign;
}

// Whether the unit vector of p is lexicographically before that of q.
bool is_before(const SpacePoint& p, const SpacePoint& q) {
    const SpaceLattice<2> lattice({p, q});
    return at_width_of(lattice, [&]<int N>() {
        const auto u = vector_of<N>(lattice, 0), v = vector_of<N>(lattice, 1);
        const auto length_u = square(u), length_v = square(v);  // squared
        const auto compare = [&](const Wide<N>& a, const Wide<N>& b) {
            return sign_of_sum(a.sign(), -b.sign(),
                               [&] { return (a * a * length_v - b * b * length_u).sign(); });
        };
        int sign = compare(u.x, v.x);
        if (sign == 0) sign = compare(u.y, v.y);
        if (sign == 0) sign = compare(u.z, v.z);
        return sign < 0;
    });
}

int side_by_rule(const SpacePoint (&p)[4]) {
    for (int i = 1; i < 4; ++i)
        for (int j = 0; j < i; ++j)
            if (have_one_direction(p[i], p[j])) return 0;
    int order[4] = {0, 1, 2, 3};
    std::sort(order, order + 4, [&](int i, int j) { return is_before(p[j], p[i]); });
    for (int i : order)
        if (const int sign = perturbed_side(p, i, -1); sign != 0) return sign;
    for (int axis : {2, 1})
        for (int i = 1; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                if (turn(p[i], p[j], axis) != 0) return perturbed_side(p, order[0], axis);
    return perturbed_side(p, order[0], 0);
}

}  // namespace

UnitVector unit_vector(const SpacePoint& p) {
    const auto [x, y, z] = scaled(p);
    const DoubleWord<double> length =
        square_root(exact_product(x, x) + exact_product(y, y) + exact_product(z, z));
    return {DoubleWord<double>{x, 0} / length, DoubleWord<double>{y, 0} / length,
            DoubleWord<double>{z, 0} / length};
}

Ray::Ray(const SpacePoint& p) : given(p) {
    const auto [x, y, z] = scaled(p);
    const double length = std::sqrt(x * x + y * y + z * z);
    unit = {x / length, y / length, z / length};
}

bool have_one_direction(const SpacePoint& p, const SpacePoint& q) {
    for (int axis = 0; axis < 3; ++axis)
        if (turn(p, q, axis) != 0) return false;
    const auto is_same = [](double a, double b) {
        return (a > 0) == (b > 0) && (a < 0) == (b < 0);
    };
    return is_same(p.x, q.x) && is_same(p.y, q.y) && is_same(p.z, q.z);
}

bool is_direction_before(const SpacePoint& p, const SpacePoint& q) {
    const auto face = [](const SpacePoint& r) {
        const double x = std::fabs(r.x), y = std::fabs(r.y), z = std::fabs(r.z);
        const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
        return 2 * axis + std::signbit(axis == 0 ? r.x : axis == 1 ? r.y : r.z);
    };
    const int at = face(p), other = face(q);
    if (at != other) return at < other;
    for (int axis = 0; axis < 3; ++axis)
        if (const int sign = axis == at / 2 ? 0 : turn(p, q, axis); sign != 0) return sign > 0;
    return false;
}

int ray_side_unperturbed(const Ray& a, const Ray& b, const Ray& c, const Ray& d) {
    if (const int sign = side_in_double_words(a, b, c, d); sign != 0) return sign;
    const Ray* const rays[] = {&a, &b, &c, &d};
    for (int i = 1; i < 4; ++i)
        for (int j = 0; j < i; ++j)
            if (have_one_direction(*rays[i], *rays[j])) return 0;
    return sign_of_four_roots(a.given, b.given, c.given, d.given);
}

int ray_side_exact(const Ray& a, const Ray& b, const Ray& c, const Ray& d) {
    const int sign = ray_side_unperturbed(a, b, c, d);
    return sign != 0 ? sign : side_by_rule({a.given, b.given, c.given, d.given});
}

}  // namespace liftmesh
