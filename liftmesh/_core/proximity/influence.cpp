#include "proximity/influence.hpp"

#include "parallel/blocks.hpp"
#include "predicates/distances.hpp"
#include "sorting/kd_tree.hpp"

namespace liftmesh {

namespace {

constexpr Row none = ~Row{0};

// The vertex nearest to each, which is a neighbour of it.
bool find_nearest(const EdgeSides& sides, Interrupt& interrupt, std::vector<Row>& nearest) {
    const auto look = [&](std::int32_t from, std::int32_t to) {
        Row& best = nearest[static_cast<std::size_t>(from)];
        const Point at = sides.place(from);
        if (best == none || compare_distances(at, sides.place(to), at,
                                              sides.place(static_cast<std::int32_t>(best))) < 0)
            best = static_cast<Row>(to);
    };
    return for_each_in_blocks(sides.count(), interrupt, [&](std::size_t i) {
        const auto side = static_cast<Side>(i);
        if (!sides.is_first(side)) return;
        look(sides.tail(side), sides.head(side));
        look(sides.head(side), sides.tail(side));
    });
}

struct Circles {
    const std::vector<Point>& centres;
    std::vector<Row> nearest;
    std::vector<double> radii;

    bool do_cross(Row a, Row b) const {
        return do_circles_cross(centres[a], centres[nearest[a]], centres[b], centres[nearest[b]]);
    }
};

// Those of one power of two.
struct Level {
    KdTree tree;
    double greatest;  // radius, and a little more
};

// What boxes of a level are asked for one circle.
class Query {
 public:
    Query(const Circles& circles, Row row, const Level& level, bool is_own, Edges& edges)
        : circles_(circles), row_(row), level_(level), is_own_(is_own), edges_(edges) {}

    void visit(Row row, Point) {
        if ((row > row_ || !is_own_) && circles_.do_cross(row_, row))
            edges_.push_back({static_cast<std::int32_t>(row_), static_cast<std::int32_t>(row)});
    }

    // By how much distances exceed the radius in the centre of the box, with q on the circle:
    //     |c - p| - |q - p| = (c - q) . ((c - p) + (q - p)) / (|c - p| + |q - p|),
    // and at most by how much less elsewhere in it. Where that is no number, the box may meet.
    bool meets(const TreeBox& box) const {
        const Point p = circles_.centres[row_], q = circles_.centres[circles_.nearest[row_]];
        const Point c = box.centre, half = box.half;
        const double x = c.x - p.x, y = c.y - p.y, from_x = c.x - q.x, from_y = c.y - q.y;
        const double length = std::hypot(x, y), both = length + circles_.radii[row_];
        const double excess = from_x * ((x + (q.x - p.x)) / both) +
                              from_y * ((y + (q.y - p.y)) / both) -
                              (std::fabs(x / length) * half.x + std::fabs(y / length) * half.y);
        const double error =
            0x1p-48 * (std::fabs(from_x) + std::fabs(from_y) + half.x + half.y) + 0x1p-1070;
        return !(excess - error > level_.greatest);
    }
    bool ends() const { return false; }
    double distance(const TreeBox&) const { return 0; }  // all that meet are visited, in any order

 private:
    const Circles& circles_;
    Row row_;
    const Level& level_;
    bool is_own_;  // where both ends of an edge find it, it is that of the first
    Edges& edges_;
};

std::vector<Level> levels_of(const Circles& circles, Patience& patience) {
    std::map<int, std::vector<Row>> rows;
    for (std::size_t i = 0; i < circles.centres.size() && !patience.ends(); ++i)
        // Another thread may have put there what has no order.
        if (is_finite(circles.centres[i]))
            rows[std::ilogb(circles.radii[i])].push_back(static_cast<Row>(i));
    std::vector<Level> levels;
    for (auto& [exponent, some] : rows) {
        double greatest = 0;
        for (const Row row : some) greatest = std::max(greatest, circles.radii[row]);
        levels.push_back({KdTree(circles.centres, std::move(some), &patience),
                          greatest * (1 + 0x1p-50) + 0x1p-1070});
    }
    return levels;
}

}  // namespace

bool find_influence(const EdgeSides& sides, Interrupt& interrupt, Edges& edges) {
    const std::size_t count = sides.points().size();
    Circles circles{sides.points(), std::vector<Row>(count, none), std::vector<double>(count)};
    const bool done = find_nearest(sides, interrupt, circles.nearest) &&
                      for_each_in_blocks(count, interrupt, [&](std::size_t i) {
                          circles.radii[i] =
                              distance(circles.centres[i], circles.centres[circles.nearest[i]]);
                      });
    if (!done) return false;
    Patience patience(interrupt);
    const std::vector<Level> levels = levels_of(circles, patience);
    for (const Level& level : levels) {
        // Along the tree, as neighbours meet the same boxes.
        for (const Row row : level.tree.rows()) {
            for (const Level* other = levels.data(); other <= &level; ++other) {
                Query query(circles, row, *other, other == &level, edges);
                other->tree.search(query);
                if (patience.ends(8)) return false;
            }
        }
    }
    return !interrupt.requested();
}

}  // namespace liftmesh
