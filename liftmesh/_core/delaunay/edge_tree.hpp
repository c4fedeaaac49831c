// Edges as cuts: a binary space partition by the lines of sampled edges of the triangulation. It
// leads near a query in few steps where a walk from the nearest vertices does not: in fans, and
// among slivers that are longer than their vertices are apart. There the edges hardly cross each
// other's lines, so that the tree is as small as the sample; where they are short, few lines are
// cut. (Edges that are all nearly on one line leave it no good cuts.) A leaf is a convex cell that
// holds few edges, and the walk that follows begins at an edge on its border.
//
// Sides are exact; which part of an edge lies in a cell is rounded, and whether it is right changes
// the length of a walk, never its end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/site.hpp"
#include "base/status.hpp"
#include "delaunay/triangulated.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

class EdgeTree {
 public:
    EdgeTree(const Triangulated& mesh, Patience& patience);

    // Reorders the queries by leaves, and calls visit(first, last, triangle) for each leaf that has
    // some, with a triangle nearby; -1 beyond an edge of the hull.
    template <class Visit>
    void descend(Site* first, Site* last, const Visit& visit) const {
        descend(0, first, last, visit);
    }

 private:
    // Nodes stand in preorder: the left child, if there is one, follows its parent.
    struct Node {
        std::uint32_t has_left : 1;
        std::uint32_t edge : 31;  // 3 t + k: opposite vertex k of the triangle t, which is left
        std::uint32_t right;      // 0 if there is none
    };
    struct Line {
        Point tail, head;
    };
    // The part of an edge in a cell, as shares of its length.
    struct Piece {
        std::uint32_t edge;
        float from, to;

        bool is_empty() const { return from >= to; }
    };
    class Builder;

    static Line line(const Triangulated& mesh, std::uint32_t edge) {
        const auto t = static_cast<std::int32_t>(edge / 3);
        const int k = static_cast<int>(edge % 3);
        return {mesh.corner(t, (k + 1) % 3), mesh.corner(t, (k + 2) % 3)};
    }

    template <class Visit>
    void descend(std::size_t at, Site* first, Site* last, const Visit& visit) const {
        const Node node = nodes_[at];
        const Line cut = line(mesh_, node.edge);
        Site* middle = std::partition(first, last, [&](const Site& query) {
            return orient2d(cut.tail, cut.head, query.point) >= 0;
        });
        const auto triangle = static_cast<std::int32_t>(node.edge / 3);
        if (first != middle) {
            if (node.has_left) {
                descend(at + 1, first, middle, visit);
            } else {
                visit(first, middle, triangle);
            }
        }
        if (middle != last) {
            if (node.right != 0) {
                descend(node.right, middle, last, visit);
            } else {
                visit(middle, last, mesh_.neighbor(triangle, static_cast<int>(node.edge % 3)));
            }
        }
    }

    const Triangulated& mesh_;
    std::vector<Node> nodes_;
};

}  // namespace liftmesh
