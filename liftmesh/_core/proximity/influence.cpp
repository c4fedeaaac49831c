#include "proximity/influence.hpp"

#include "parallel/blocks.hpp"
#include "predicates/distances.hpp"
#include "sorting/kd_tree.hpp"

namespace liftmesh {

namespace {

constexpr Row none = ~Row{0};

// The vertex nearest to each, which is a neighbour of it.
bool find_nearest(const Sides& sides, Interrupt& interrupt, std::vector<Row>& nearest) {
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

// What boxes are asked for one circle. Distances are bounded by the longer of both coordinates,
// which neither overflows where it matters nor underflows.
class Query {
 public:
    Query(const Circles& circles, Row row, Edges& edges)
        : circles_(circles), row_(row), edges_(edges) {}

    void visit(Row row, Point) {
        if (row > row_ && circles_.do_cross(row_, row))
            edges_.push_back({static_cast<std::int32_t>(row_), static_cast<std::int32_t>(row)});
    }
    bool meets(const TreeBox& box) const {
        const Point at = circles_.centres[row_];
        return !(gap(at.x, box.centre.x, box.half.x) > reach(box)) &&
               !(gap(at.y, box.centre.y, box.half.y) > reach(box));
    }
    bool ends() const { return false; }
    double distance(const TreeBox&) const { return 0; }  // all that meet are visited, in any order

 private:
    static constexpr double share = 0x1p-50, least = 0x1p-1072;

    double reach(const TreeBox& box) const {
        return (circles_.radii[row_] + box.reach) * (1 + share) + least;
    }
    static double gap(double from, double centre, double half) {
        return std::fabs(from - centre) * (1 - share) - half * (1 + share);
    }

    const Circles& circles_;
    Row row_;
    Edges& edges_;
};

}  // namespace

bool find_influence(const Sides& sides, Interrupt& interrupt, Edges& edges) {
    const std::size_t count = sides.points().size();
    Circles circles{sides.points(), std::vector<Row>(count, none), std::vector<double>(count)};
    std::vector<Row> vertices;
    const bool done = find_nearest(sides, interrupt, circles.nearest) &&
                      for_each_in_blocks(count, interrupt, [&](std::size_t i) {
                          const Point centre = circles.centres[i];
                          circles.radii[i] = distance(centre, circles.centres[circles.nearest[i]]);
                          // Another thread may have put there what has no order.
                          if (is_finite(centre)) vertices.push_back(static_cast<Row>(i));
                      });
    if (!done) return false;
    Patience patience(interrupt);
    KdTree tree(circles.centres, vertices, &patience);
    if (interrupt.requested()) return false;
    tree.set_reaches(circles.radii);
    // Along the tree, as neighbours meet the same boxes.
    return for_each_in_blocks(vertices.size(), interrupt, [&](std::size_t i) {
        Query query(circles, tree.rows()[i], edges);
        tree.search(query);
    });
}

}  // namespace liftmesh
