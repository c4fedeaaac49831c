// Section 3: the first edge of the lower convex hull.
//
// P is projected in the direction of the x-axis onto the plane Oyz, drawn with the y-axis from
// right to left (which is the view from x = -infinity, where the paper prints +infinity). v'_1 is
// the lowest point of the projection P'. All others are on or to the left of v'_1 v'_2, and on or
// to the right of v'_1 v'_n.
#pragma once

#include <optional>

#include "base/status.hpp"
#include "paper/points.hpp"

namespace liftmesh::paper {

struct FirstEdge {
    Vertex v1, v2, vn;
    Vertex end;  // v2 or vn: [v1, end] is an edge of CH_L(P)
};

template <class Points>
class FirstEdgeSearch {
 public:
    FirstEdgeSearch(const Points& points, Patience& patience) : p_(points), patience_(patience) {}

    // None if all points have the same y: then CH_L(P) has no facet.
    std::optional<FirstEdge> find() {
        const auto n = static_cast<Vertex>(p_.size());
        Vertex v1 = 0;
        for (Vertex v = 1; v < n && !patience_.ends(step); ++v)
            if (is_lower(v, v1)) v1 = v;
        Vertex v2 = v1 == 0 ? 1 : 0, vn = v2;
        for (Vertex v = 0; v < n && !patience_.ends(step); ++v) {
            if (v == v1) continue;
            if (v != v2 && is_to_the_right(v1, v2, v)) v2 = v;
            if (v != vn && is_to_the_right(v1, v, vn)) vn = v;
        }
        // The three cases: in this view smaller y is further right. An edge of P' is used if it is
        // not vertical in Oyz; a vertical one says nothing about edges of CH_L(P).
        if (p_[v2].y < p_[v1].y) return FirstEdge{v1, v2, vn, v2};
        if (p_[v1].y < p_[vn].y) return FirstEdge{v1, v2, vn, vn};
        return std::nullopt;
    }

 private:
    // The weight of a comparison, which takes microseconds if q is far away.
    static constexpr std::size_t step = 16;

    // Of equally low points the lexicographically least is lifted least by the perturbation.
    bool is_lower(Vertex u, Vertex v) const {
        const int sign = p_.compare_z(u, v);
        return sign != 0 ? sign < 0 : before_xy(p_.planar(u), p_.planar(v));
    }

    // Whether w is strictly to the right of the line from u to v in this view: with y to the right
    // the three turn counter-clockwise. Of collinear points the lexicographically largest is lifted
    // most, and decides unless the other two have the same y; then the next largest does.
    bool is_to_the_right(Vertex u, Vertex v, Vertex w) const {
        int sign = p_.turn_in_oyz(u, v, w);
        if (sign == 0) sign = perturbed_turn(u, v, w);
        return sign > 0;
    }

    // Lifting w makes u, v, w counter-clockwise if v has a larger y than u; and cyclically.
    int perturbed_turn(Vertex u, Vertex v, Vertex w) const {
        Vertex turned[3] = {u, v, w};
        for (int rest = 3; rest > 0; --rest) {
            int largest = 0;
            for (int i = 1; i < rest; ++i)
                if (before_xy(p_.planar(turned[largest]), p_.planar(turned[i]))) largest = i;
            if (const int sign = side_of(turned[largest], u, v, w); sign != 0) return sign;
            std::swap(turned[largest], turned[rest - 1]);
        }
        return 0;
    }

    int side_of(Vertex lifted, Vertex u, Vertex v, Vertex w) const {
        const auto run = [&](Vertex from, Vertex to) {
            return (p_[from].y < p_[to].y) - (p_[from].y > p_[to].y);
        };
        return lifted == w ? run(u, v) : lifted == v ? run(w, u) : run(v, w);
    }

    const Points& p_;
    Patience& patience_;
};

}  // namespace liftmesh::paper
