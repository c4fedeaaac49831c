#include "surface/nearest.hpp"

#include <cmath>
#include <initializer_list>

#include "base/input.hpp"
#include "predicates/compare_heights.hpp"

namespace liftmesh {

namespace {

constexpr int most_steps = 64;

// A rounded sum of two products of differences is off by less than this share of the products'
// magnitudes, each rounding being one of 2^-53, or by less than the second number where products
// are too small for that.
constexpr double share = 0x1p-50, tiny = 0x1p-1000;

double square_of_distance(Point p, Point q) {
    const double x = p.x - q.x, y = p.y - q.y;
    return x * x + y * y;
}

// Whether the direction from a vertex to p is surely at least a right angle from that to the point.
bool is_turned_away(Point vertex, Point p, Point query) {
    const double x = (p.x - vertex.x) * (query.x - vertex.x);
    const double y = (p.y - vertex.y) * (query.y - vertex.y);
    return x + y < -(share * (std::fabs(x) + std::fabs(y)) + tiny);
}

class NearestWalk {
 public:
    NearestWalk(const Triangulated& mesh, Point query, std::int32_t simplex)
        : mesh_(mesh), query_(query), at_(simplex), k_(0), best_(mesh.corner(simplex, 0)) {
        for (int k = 1; k < 3; ++k) look_at(simplex, k);
    }

    std::int32_t run() {
        for (bool is_first = true; goes_on(is_first); is_first = false) {
        }
        return left_ < 0 ? -1 : mesh_.vertex(at_, k_);
    }

 private:
    // Whether a corner is nearer than the best, which it then is.
    bool look_at(std::int32_t simplex, int k) {
        const Point p = mesh_.corner(simplex, k);
        if (!is_nearer(p, best_, query_)) return false;
        at_ = simplex;
        k_ = k;
        best_ = p;
        return true;
    }

    // Goes around the best vertex, to both sides. Whether a neighbour was nearer.
    bool goes_on(bool is_first) {
        const std::int32_t start = at_, row = mesh_.vertex(at_, k_);
        for (const int turn : {1, 2}) {
            int k = k_;
            for (std::int32_t simplex = start;;) {
                // Across the side with the vertex and the corner that is `turn` further.
                const std::int32_t across = mesh_.neighbor(simplex, (k + 3 - turn) % 3);
                if (across < 0) break;
                if (across == start) return false;
                if (--left_ < 0) return false;
                k = corner_at(across, row);
                simplex = across;
                const int added = (k + turn) % 3;
                if (look_at(simplex, added)) return true;
                if (is_first && is_turned_away(best_, mesh_.corner(simplex, added), query_)) break;
            }
        }
        return false;
    }

    int corner_at(std::int32_t simplex, std::int32_t row) const {
        return (mesh_.vertex(simplex, 1) == row) + 2 * (mesh_.vertex(simplex, 2) == row);
    }

    const Triangulated& mesh_;
    Point query_;
    std::int32_t at_;
    int k_;
    Point best_;
    int left_ = most_steps;
};

}  // namespace

bool is_nearer(Point p, Point q, Point query) {
    const double of_p = square_of_distance(p, query), of_q = square_of_distance(q, query);
    const double difference = of_p - of_q, error = share * (of_p + of_q) + tiny;
    if (difference > error) return false;
    if (-difference > error) return true;
    if (!is_finite(p) || !is_finite(q)) return false;
    const int order = compare_heights(p, q, query);
    return order < 0 || (order == 0 && before_xy(p, q));
}

std::int32_t nearest_vertex(const Triangulated& mesh, Point query, std::int32_t simplex) {
    return NearestWalk(mesh, query, simplex).run();
}

}  // namespace liftmesh
