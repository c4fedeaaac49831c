// A tree of boxes around points: each half of a node has half of its points.
#pragma once

#include "base/point.hpp"
#include "base/status.hpp"

namespace liftmesh {

// The points of a node lie in its box: the centre and half of the extent, rounded outwards.
struct TreeBox {
    Point centre, half;
};

class KdTree {
 public:
    // Of some rows of the points. One that the interrupt has cut short is of no use.
    KdTree(std::span<const Point> points, std::vector<Row> rows, Patience* patience = nullptr);

    // The rows, neighbours near each other.
    const std::vector<Row>& rows() const { return rows_; }

    // Calls visit(row, point) for the rows of nodes that query.meets(box) does not rule out, those
    // of less query.distance(box) first, until query.ends() after a leaf.
    template <class Query>
    void search(Query& query) const {
        if (!nodes_.empty() && query.meets(nodes_[0].box)) search(0, query);
    }

 private:
    static constexpr std::uint32_t fewest = 8;
    struct Node {
        TreeBox box;
        std::uint32_t first, last, right;  // `right` is 0 for a leaf; the left child follows
    };

    void build(std::span<const Point> points, std::uint32_t first, std::uint32_t last,
               Patience* patience);

    // Whether to go on, after a node that meets the query.
    template <class Query>
    bool search(std::uint32_t at, Query& query) const {
        const Node& node = nodes_[at];
        if (node.right == 0) {
            for (std::uint32_t i = node.first; i < node.last; ++i)
                query.visit(rows_[i], points_[i]);
            return !query.ends();
        }
        std::uint32_t near = at + 1, far = node.right;
        const bool meets_near = query.meets(nodes_[near].box);
        const bool meets_far = query.meets(nodes_[far].box);
        if (!meets_near || !meets_far)
            return !(meets_near || meets_far) || search(meets_near ? near : far, query);
        if (query.distance(nodes_[far].box) < query.distance(nodes_[near].box))
            std::swap(near, far);
        return search(near, query) && (!query.meets(nodes_[far].box) || search(far, query));
    }

    std::vector<Row> rows_;
    std::vector<Point> points_;  // of the rows
    std::vector<Node> nodes_;
};

}  // namespace liftmesh
