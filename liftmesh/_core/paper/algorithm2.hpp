// Algorithm 2: the lower convex hull, wrapped facet by facet.
//
// Facets are appended as they are found, and those before `front` are finished: one array is both
// the queue Q' and the result Q. An edge is in E_L while its neighbour is `unknown`, and in E'_L
// from then on.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/facets.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "paper/first_edge.hpp"
#include "paper/open_edges.hpp"

namespace liftmesh::paper {

// `facet_through(a, b)` is LF or LFRes: the third vertex of the facet to the right of [a, b].
template <class Procedure>
class LowerConvexHull {
 public:
    LowerConvexHull(Procedure& facet_through, std::size_t points) : facet_through_(facet_through) {
        facets_.reserve(2 * points);
    }

    // [a, b] is the first edge (line 1). The paper wraps it once, and settles it; if facets lie on
    // both its sides, those of one side may then never be reached. Here it is wrapped from both.
    std::vector<Facet> wrap(Vertex a, Vertex b) {
        if (const std::optional<Vertex> p = facet_through_(a, b)) {  // line 2
            add(a, b, *p);
        } else if (const std::optional<Vertex> other = facet_through_(b, a)) {
            add(b, a, *other);
            settle(0, 2);
        }
        for (std::size_t front = 0; front < facets_.size(); ++front)  // lines 3, 4, 12
            for (unsigned k = 0; k < 3; ++k)                          // lines 5, 6
                if (facets_[front].neighbor[k] == Facet::unknown) cross(front, k);
        return std::move(facets_);
    }

 private:
    void cross(std::size_t facet, unsigned k) {
        const Vertex a = facets_[facet].tail(k), b = facets_[facet].head(k);
        if (const std::optional<Vertex> p = facet_through_(a, b)) {  // lines 7, 8
            add(a, b, *p);                                           // lines 9, 10
        } else {
            settle(facet, k);  // line 11
        }
    }

    // A bound-edge: it moves from E_L to E'_L.
    void settle(std::size_t facet, unsigned k) {
        facets_[facet].neighbor[k] = Facet::none;
        open_.take(facets_[facet].tail(k), facets_[facet].head(k));
    }

    // The facet to the right of [a, b], whose edge 2 is that one, reversed. Its edges meet those
    // that are open, or are open themselves.
    void add(Vertex a, Vertex b, Vertex p) {
        const auto added = static_cast<std::uint32_t>(facets_.size());
        facets_.push_back({{b, a, p}});
        for (unsigned k = 0; k < 3; ++k) {
            const Vertex tail = facets_[added].tail(k), head = facets_[added].head(k);
            if (const std::optional<OpenEdges::Place> other = open_.take(head, tail)) {
                facets_[added].neighbor[k] = other->facet;
                facets_[other->facet].neighbor[other->k] = added;
            } else {
                open_.put(tail, head, {added, k});
            }
        }
    }

    Procedure& facet_through_;
    std::vector<Facet> facets_;
    OpenEdges open_;
};

// The whole algorithm, with the first edge. There are no facets if all points are collinear.
template <class Points, class Procedure>
Status lower_convex_hull(const Points& points, Procedure& facet_through, Interrupt& interrupt,
                         std::vector<Facet>& facets) {
    Patience patience(interrupt);
    const std::optional<FirstEdge> e1 = FirstEdgeSearch(points, patience).find();
    if (patience.ends(0)) return Status::interrupted;
    if (e1) facets = LowerConvexHull(facet_through, points.size()).wrap(e1->v1, e1->end);
    return facet_through.interrupted() ? Status::interrupted : Status::ok;
}

}  // namespace liftmesh::paper
