// Point location in O(log n) expected steps in every triangulation: a trapezoidal map of a random
// sample of its edges (Mulmuley, "A Fast Planar Partition Algorithm", 1990; Seidel, "A Simple and
// Fast Incremental Randomized Algorithm for Computing Trapezoidal Decompositions", 1991; de Berg
// and others, "Computational Geometry", chapter 6).
//
// From each end of an edge a wall goes up and down to the next edges. The walls and edges cut the
// plane into trapezoids: each has an edge above, one below, and a vertex left and right. An edge
// is added by splitting the trapezoids that it crosses; a wall that it cuts off from its vertex
// goes, and what was on either side is one trapezoid again. The history of all splits is the search
// structure: a directed graph, in which a query goes left or right of an end, above or below an
// edge, down to its trapezoid. In random order that takes O(log r) expected steps for r edges, and
// the graph has O(r) nodes, whatever the edges. A vertical walk inside the trapezoid leads to the
// triangle, and crosses as many edges as lie between two of the sample: a constant, in expectation.
//
// Only coordinates are compared, and exact orientations computed: nothing is cut or rounded. Walls
// lean infinitesimally, as vertical walks do, so no two vertices are on one vertical line, and
// edges have no point in common but ends: no input needs a rule of its own.
#pragma once

#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/triangulated.hpp"
#include "delaunay/walk.hpp"

namespace liftmesh {

// The lower or the upper edges of the hull, whichever are fewer, from left to right: every vertical
// line through the triangulation meets one of them.

class HullChain {
 public:
    HullChain(const Triangulated& mesh, Patience& patience);

    // The edge that the vertical line through a point meets; `no_edge` left and right of the hull.
    std::uint32_t at(Point p) const;

    std::size_t size() const { return edges_.size(); }

 private:
    const Triangulated& mesh_;
    std::vector<std::uint32_t> edges_;
};

class TrapezoidMap {
 public:
    // The secret is the seed of the sample. Whoever knows the sample can make a triangulation for
    // which it is a bad one.
    TrapezoidMap(const Triangulated& mesh, std::uint64_t secret, Patience& patience);
    TrapezoidMap(const Triangulated& mesh, std::size_t edges, std::uint64_t secret,
                 Patience& patience);

    // Reorders the queries by trapezoids, and calls visit(bundle) for some at a time, with an edge
    // that the vertical line through each of them meets; `no_edge` if it meets no triangle.
    template <class Visit>
    void descend(Site* first, Site* last, const Visit& visit) const;

 private:
    enum class Kind : std::uint32_t { trapezoid, end, edge };

    static constexpr std::uint32_t none = (std::uint32_t{1} << 30) - 1;

    // A node of the history: a trapezoid, or what split it. Edges are named by their place in the
    // sample; 2 i and 2 i + 1 are the left and the right end of edge i.
    struct Node {
        Node(Kind kind, std::uint32_t item, std::uint32_t one, std::uint32_t other,
             std::uint32_t over = none)
            : tag(item << 2 | static_cast<std::uint32_t>(kind)),
              first(one),
              second(other),
              above(over) {}

        Kind kind() const { return static_cast<Kind>(tag & 3); }
        std::uint32_t item() const { return tag >> 2; }

        std::uint32_t tag;            // the end or edge that splits; of a trapezoid the edge below
        std::uint32_t first, second;  // what is left and right of the end, or below and above the
                                      // edge; of a trapezoid the ends that its walls go through
        std::uint32_t above;          // of a trapezoid: the edge
    };
    class Builder;

    template <class Visit>
    void visit_trapezoid(const Node& trapezoid, Site* first, Site* last, const Visit& visit) const;
    std::size_t affordable_edges() const;
    std::uint32_t sampled(std::uint32_t place) const;
    template <class Visit>
    static void visit_bundles(Site* first, Site* last, std::uint32_t edge, const Visit& visit);
    std::uint32_t edge_of(std::uint32_t item) const;
    Site* sort_by_height(const Node& trapezoid, Site* first, Site* last) const;
    double share_of_height(const Node& trapezoid, Point p) const;
    double height(std::uint32_t place, Point p) const;

    // Whether a query is right of an end or above an edge, or on it.
    bool is_second(const Node& node, Point query) const {
        if (node.kind() == Kind::end) return !before_xy(query, ends_[node.item()]);
        return orient2d(ends_[2 * node.item()], ends_[2 * node.item() + 1], query) >= 0;
    }

    const Triangulated& mesh_;
    std::uint64_t secret_;
    HullChain hull_;
    std::vector<Point> ends_;
    std::vector<Node> nodes_;
};

template <class Visit>
void TrapezoidMap::descend(Site* first, Site* last, const Visit& visit) const {
    struct Portion {
        std::uint32_t at;
        Site *first, *last;
    };
    std::vector<Portion> parts{{0, first, last}};
    while (!parts.empty()) {
        Portion part = parts.back();
        parts.pop_back();
        while (part.first != part.last && nodes_[part.at].kind() != Kind::trapezoid) {
            const Node& node = nodes_[part.at];
            Site* middle = std::partition(part.first, part.last, [&](const Site& query) {
                return !is_second(node, query.point);
            });
            if (middle != part.last) parts.push_back({node.second, middle, part.last});
            part = {node.first, part.first, middle};
        }
        if (part.first == part.last) continue;
        visit_trapezoid(nodes_[part.at], part.first, part.last, visit);
    }
}

// The lower half from the lower edge up, the upper half from the upper edge down.
template <class Visit>
void TrapezoidMap::visit_trapezoid(const Node& trapezoid, Site* first, Site* last,
                                   const Visit& visit) const {
    const std::uint32_t lower = edge_of(trapezoid.item()), upper = edge_of(trapezoid.above);
    if (lower == no_edge && upper == no_edge) {
        for (; first != last; ++first) visit(Bundle{first, first + 1, hull_.at(first->point)});
        return;
    }
    Site* middle = sort_by_height(trapezoid, first, last);
    std::reverse(middle, last);
    visit_bundles(first, middle, lower != no_edge ? lower : upper, visit);
    visit_bundles(middle, last, upper != no_edge ? upper : lower, visit);
}

// Few queries each, so that bundles can be worked on in turn.
template <class Visit>
void TrapezoidMap::visit_bundles(Site* first, Site* last, std::uint32_t edge, const Visit& visit) {
    constexpr std::ptrdiff_t together = 64;
    while (first != last) {
        Site* next = first + std::min(together, last - first);
        visit(Bundle{std::exchange(first, next), next, edge});
    }
}

}  // namespace liftmesh
