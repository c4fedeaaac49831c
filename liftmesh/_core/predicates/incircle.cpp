#include "predicates/incircle.hpp"

#include "predicates/fixed_point.hpp"
#include "predicates/lifted_determinant.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

// By the distances and heights of seen_from_base.hpp.
int sign_of_side(const FixedPoint<4>& points) {
    const Step base = points.step(0, 1), to_c = points.step(0, 2), to_d = points.step(0, 3);
    return sign_of_difference(dot(to_c, points.step(1, 2)), cross(base, to_d),
                              dot(to_d, points.step(1, 3)), cross(base, to_c));
}

// The corners of an axis-parallel rectangle, as every cell of a raster: two values of x, two of y,
// each shared by two of the four distinct points.
bool is_rectangle(Point a, Point b, Point c, Point d) {
    const auto corner = [](Point p, Point q, Point r, Point s) {
        return (p.x == q.x) & (r.x == s.x) & (q.y == r.y) & (s.y == p.y);
    };
    if ((a.x != b.x) & (a.x != c.x) & (a.x != d.x)) return false;
    return corner(a, b, c, d) || corner(b, c, d, a) || corner(a, b, d, c) || corner(b, d, c, a) ||
           corner(a, c, b, d) || corner(c, b, d, a);
}

// The filter outside the window: the differences are scaled by a power of two so that the largest
// is near 1, where an underflow costs at most a few times 2^-1074.
int sign_by_scaled_filter(Point a, Point b, Point c, Point d) {
    double largest = 0;
    for (Point p : {a, b, c})
        largest = std::max({largest, std::fabs(p.x - d.x), std::fabs(p.y - d.y)});
    if (!std::isfinite(largest) || largest < 0x1p-960) return 0;
    const double scale = std::ldexp(1.0, -std::ilogb(largest));
    const auto scaled = [&](Point p) { return Point{(p.x - d.x) * scale, (p.y - d.y) * scale}; };
    const InCircleFilter filter = incircle_filter(scaled(a), scaled(b), scaled(c), {0, 0});
    // Scaling rounds a difference, which the bound does not count, only if it becomes denormal: the
    // constant covers that.
    const double error = filter.error + 1e-290;
    return (filter.det > error) - (-filter.det > error);
}

// Out of line: on rasters most exact calls are for rectangles, and need none of its stack.
[[gnu::noinline]] int sign_by_integers(Point a, Point b, Point c, Point d, Guard guard) {
    if (!guard.vouches())
        if (const int sign = sign_by_scaled_filter(a, b, c, d); sign != 0) return sign;
    if (const FixedPoint<4> points({a, b, c, d}); points.fits()) return sign_of_side(points);
    return sign_of_wide_side(
        LiftedLattice<Paraboloid, 4>({}, {{a, {}}, {b, {}}, {c, {}}, {d, {}}}));
}

}  // namespace

int incircle_exact(Point a, Point b, Point c, Point d, Guard guard) {
    return is_rectangle(a, b, c, d) ? 0 : sign_by_integers(a, b, c, d, guard);
}

int incircle_canonical_exact(Point a, Point b, Point c, Point d, Guard guard) {
    const int sign = incircle_exact(a, b, c, d, guard);
    return sign != 0 ? sign : perturbed_sign(a, b, c, d);
}

namespace {

// By lexicographic order, the largest first.
struct Descending {
    explicit Descending(const Point (&points)[4]) {
        int larger[4] = {};  // how many points are larger than this one
        for (int j = 1; j < 4; ++j) {
            for (int i = 0; i < j; ++i) {
                const bool ascends = before_xy(points[i], points[j]);
                larger[i] += ascends;
                larger[j] += !ascends;
            }
        }
        for (int i = 0; i < 4; ++i) place[larger[i]] = i;
    }
    int place[4];
};

int largest_of(const Point (&points)[4]) {
    const int first = before_xy(points[0], points[1]), last = 2 + before_xy(points[2], points[3]);
    return before_xy(points[first], points[last]) ? last : first;
}

}  // namespace

// The lexicographically largest of the four points is lifted most. If it is d, d leaves the circle;
// otherwise d replaces it in the triangle, and the orientation of the new triangle is the sign.
// Where that is degenerate, as it never is on a circle, the next largest point decides. The sign is
// 0 if a, b, c are collinear or d coincides with one of them; reversing the triangle reverses it.
int perturbed_sign(Point a, Point b, Point c, Point d) {
    const int turn = orient2d(a, b, c);
    if (turn == 0 || d == a || d == b || d == c) return 0;
    const Point points[4] = {a, b, c, d};
    const auto side_without = [&](int i) {
        return orient2d(i == 0 ? d : a, i == 1 ? d : b, i == 2 ? d : c);
    };
    const int largest = largest_of(points);
    if (largest == 3) return -turn;
    if (const int side = side_without(largest); side != 0) return side;
    for (int i : Descending(points).place) {
        if (i == 3) break;
        if (const int side = side_without(i); side != 0) return side;
    }
    return -turn;
}

}  // namespace liftmesh
