#include "proximity/proximity.hpp"

#include "parallel/blocks.hpp"
#include "predicates/distances.hpp"
#include "proximity/influence.hpp"
#include "proximity/relative.hpp"

namespace liftmesh {

namespace {

// If a point is in the disc, on one side of the edge, then so is the third corner of the triangle
// there: else the circle of this triangle would hold the whole half of the disc, and so the point.
bool is_gabriel(const EdgeSides& sides, Side side) {
    const Point a = sides.place(sides.tail(side)), b = sides.place(sides.head(side));
    const auto is_outside = [&](Side at) {
        return at == no_side || sign_at_apex(a, b, sides.place(sides.opposite(at))) > 0;
    };
    return is_outside(side) && is_outside(sides.across(side));
}

bool find_gabriel(const EdgeSides& sides, Interrupt& interrupt, Edges& edges) {
    return for_each_in_blocks(sides.count(), interrupt, [&](std::size_t i) {
        const auto side = static_cast<Side>(i);
        if (sides.is_first(side) && is_gabriel(sides, side))
            edges.push_back({sides.tail(side), sides.head(side)});
    });
}

// Edges between vertices.
bool find_edges(const EdgeSides& sides, Proximity kind, Interrupt& interrupt, Edges& edges) {
    switch (kind) {
        case Proximity::gabriel:
            return find_gabriel(sides, interrupt, edges);
        case Proximity::relative_neighborhood:
            return find_relative_neighbors(sides, interrupt, edges);
        case Proximity::minimum_spanning_tree:
            return find_relative_neighbors(sides, interrupt, edges) &&
                   span(sides, interrupt, edges);
        case Proximity::sphere_of_influence:
            return find_influence(sides, interrupt, edges);
    }
    return false;  // GCOV_EXCL_LINE: there are no other kinds
}

}  // namespace

bool find_proximity_graph(const Triangulated& mesh, Proximity kind, Interrupt& interrupt,
                          Edges& edges) {
    const EdgeSides sides(mesh, interrupt);
    if (interrupt.requested() || !find_edges(sides, kind, interrupt, edges)) return false;
    for (auto& [a, b] : edges) {
        a = sides.row(a);
        b = sides.row(b);
    }
    return true;
}

bool find_lengths(const Input& points, std::span<const Edge> edges, Interrupt& interrupt,
                  double* lengths) {
    return for_each_in_blocks(edges.size(), interrupt, [&](std::size_t i) {
        const auto [a, b] = edges[i];
        lengths[i] =
            distance(points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]);
    });
}

}  // namespace liftmesh
