#include "surface/nearest.hpp"

#include "base/input.hpp"
#include "delaunay/first_containing.hpp"
#include "predicates/distances.hpp"

namespace liftmesh {

namespace {

// A rounded sum of two products of differences is off by less than this share of the products'
// magnitudes, each rounding being one of 2^-53, or by less than the second number where products
// are too small for that.
constexpr double share = 0x1p-50, tiny = 0x1p-1000;

// Whether the direction from a vertex to p is surely at least a right angle from that to the point.
bool is_turned_away(Point vertex, Point p, Point query) {
    const double x = (p.x - vertex.x) * (query.x - vertex.x);
    const double y = (p.y - vertex.y) * (query.y - vertex.y);
    return x + y < -(share * (std::fabs(x) + std::fabs(y)) + tiny);
}

class NearestWalk {
 public:
    NearestWalk(const Triangulated& mesh, Point query, std::int32_t simplex, std::size_t& steps)
        : mesh_(mesh),
          query_(query),
          is_within_(simplex >= 0),
          at_(is_within_ ? simplex : 0),
          k_(0),
          best_(mesh.corner(at_, 0)),
          left_(steps) {
        const std::int32_t start = at_;
        for (int k = 1; k < 3; ++k) look_at(start, k);
    }

    std::int32_t run() {
        for (bool is_first = is_within_; goes_on(is_first); is_first = false) {
        }
        return is_short_ ? unfinished : mesh_.vertex(at_, k_);
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
                is_short_ = left_ == 0;
                if (is_short_) return false;
                --left_;
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
    bool is_within_;  // the triangle where the walk begins
    std::int32_t at_;
    int k_;
    Point best_;
    std::size_t& left_;
    bool is_short_ = false;
};

// What boxes of the tree are asked. Bounds have room for all rounding.
class Search {
 public:
    Search(const Triangulated& mesh, Point query, double scale, std::int32_t start)
        : mesh_(mesh), query_(query), from_{query.x * scale, query.y * scale}, scale_(scale) {
        take(start, point(mesh.place(start)));
    }

    std::int32_t best() const { return best_; }

    void visit(Row row, Point) {
        const Point p = mesh_.points[row];
        if (is_nearer(p, at_, query_)) take(static_cast<std::int32_t>(row), p);
    }
    bool meets(const TreeBox& box) const { return distance(box) <= most_; }
    bool ends() const { return false; }

    // Its square, or less.
    double distance(const TreeBox& box) const {
        const double x = gap(from_.x, box.centre.x, box.half.x);
        const double y = gap(from_.y, box.centre.y, box.half.y);
        return (x * x + y * y) * (1 - share);
    }

 private:
    static double gap(double from, double centre, double half) {
        return std::max(std::fabs(from - centre) * (1 - share) - half * (1 + share) - tiny, 0.0);
    }
    void take(std::int32_t row, Point p) {
        best_ = row;
        at_ = p;
        most_ = square_of_distance({p.x * scale_, p.y * scale_}, from_) * (1 + share) + tiny;
    }

    const Triangulated& mesh_;
    Point query_, from_, at_{};
    double scale_, most_ = 0;
    std::int32_t best_ = 0;
};

}  // namespace

bool is_nearer(Point p, Point q, Point query) {
    if (!is_finite(p) || !is_finite(q)) return false;
    const int order = compare_distances(p, query, q, query);
    return order < 0 || (order == 0 && before_xy(p, q));
}

std::int32_t nearest_vertex(const Triangulated& mesh, Point query, std::int32_t simplex,
                            std::size_t& steps) {
    return NearestWalk(mesh, query, simplex, steps).run();
}

NearestTree::Vertices::Vertices(const Triangulated& mesh, Patience& patience)
    : places(mesh.points.rows) {
    std::vector<bool> is_vertex(mesh.points.rows);
    for (std::size_t i = 0; i < 3 * mesh.count && !patience.ends(); ++i)
        is_vertex[static_cast<std::size_t>(mesh.simplices[i])] = true;
    double most = 0;
    for (std::size_t row = 0; row < places.size() && !patience.ends(); ++row) {
        const Point at = mesh.points[row];
        if (!is_vertex[row] || !is_finite(at)) continue;
        places[row] = at;
        rows.push_back(static_cast<Row>(row));
        most = std::max({most, std::fabs(at.x), std::fabs(at.y)});
    }
    scale = std::ldexp(1, most > 0 ? std::min(-std::ilogb(most), 1000) : 0);
    for (Point& each : places) each = {each.x * scale, each.y * scale};
}

std::int32_t NearestTree::nearest(const Triangulated& mesh, Point query, std::int32_t start) const {
    Search search(mesh, query, scale_, start);
    tree_.search(search);
    return search.best();
}

}  // namespace liftmesh
