#include "predicates/perturbation.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh {

// The lexicographically largest of the four points is lifted most. If it is d, d leaves the circle;
// otherwise d replaces it in the triangle, and the orientation of the new triangle is the sign.
// Where that is degenerate, the next largest point decides. The sign is 0 if a, b, c are collinear
// or d coincides with one of them; reversing the triangle reverses it.
int perturbed_sign(Point a, Point b, Point c, Point d) {
    const int turn = orient2d(a, b, c);
    if (turn == 0 || d == a || d == b || d == c) return 0;
    const Point points[4] = {a, b, c, d};
    int larger[4] = {};  // how many points are larger than this one
    for (int j = 1; j < 4; ++j) {
        for (int i = 0; i < j; ++i) {
            const bool ascends = before_xy(points[i], points[j]);
            larger[i] += ascends;
            larger[j] += !ascends;
        }
    }
    int descending[4];
    for (int i = 0; i < 4; ++i) descending[larger[i]] = i;
    for (int i : descending) {
        if (i == 3) break;
        const Point p = i == 0 ? d : a, q = i == 1 ? d : b, r = i == 2 ? d : c;
        if (const int side = orient2d(p, q, r); side != 0) return side;
    }
    return -turn;
}

}  // namespace liftmesh
