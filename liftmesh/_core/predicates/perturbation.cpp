#include "predicates/perturbation.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh {

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
