#include "predicates/ties.hpp"

#include <algorithm>
#include <array>

#include "predicates/orient2d.hpp"

namespace liftmesh {

// Among the four points the lexicographically largest is lifted most. If that is d, it leaves the
// circle; otherwise d takes its place in the triangle, and the turn of what results tells the side.
// Where that is no triangle, the next largest decides. Points that coincide or lie on one line have
// no side; a clockwise triangle has the opposite one.
int sign_of_tie(Point a, Point b, Point c, Point d) {
    const int turn = orient2d(a, b, c);
    if (turn == 0 || d == a || d == b || d == c) return 0;
    const Point triangle[3] = {a, b, c};
    std::array<int, 4> order = {0, 1, 2, 3};
    const auto point = [&](int i) { return i == 3 ? d : triangle[i]; };
    std::sort(order.begin(), order.end(),
              [&](int i, int j) { return before_xy(point(j), point(i)); });
    for (int i : order) {
        if (i == 3) break;
        const Point p = i == 0 ? d : a, q = i == 1 ? d : b, r = i == 2 ? d : c;
        if (const int side = orient2d(p, q, r); side != 0) return side;
    }
    return -turn;
}

}  // namespace liftmesh
