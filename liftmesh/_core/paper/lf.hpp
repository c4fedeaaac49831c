// Procedure 1: LF(e, P), the lower facet to the right of an edge.
#pragma once

#include <optional>

#include "paper/facet_search.hpp"
#include "paper/plane.hpp"

namespace liftmesh::paper {

template <class Points>
class Lf : public FacetSearch<Points> {
    using FacetSearch<Points>::p_, FacetSearch<Points>::patience_, FacetSearch<Points>::counts_;

 public:
    Lf(const Points& points, Interrupt& interrupt) : FacetSearch<Points>(points, interrupt) {}

    // The third vertex p_l of the facet (a, b, p_l). None if e is a bound-edge, for which the paper
    // returns e.
    std::optional<Vertex> operator()(Vertex a, Vertex b) {
        ++counts_.calls;
        const PlaneErrors errors(p_, a, b);
        const auto n = static_cast<Vertex>(p_.size());
        for (Vertex l = 0; l < n && !patience_.ends(); ++l) {        // lines 1, 9, 10
            if (l == a || l == b) continue;                          // lines 2, 3
            const Plane plane = plane_through(p_[a], p_[b], p_[l]);  // line 4
            if (!points_down(plane, errors, p_.planar(a), p_.planar(b), p_.planar(l)))
                continue;  // line 5
            ++counts_.candidate_planes;
            if (!any_below(plane, errors.dot, a, b, l)) return l;  // lines 6, 7, 8
        }
        return std::nullopt;  // line 11
    }

 private:
    // n . p > d means that p is below. Within the error of the dot product the exact predicate
    // decides.
    bool any_below(const Plane plane, double error, Vertex a, Vertex b, Vertex l) {
        const SpacePoint* const p = p_.data();
        const auto n = static_cast<Vertex>(p_.size());
        Vertex v = 0;
        for (; v < n; ++v) {
            const double side = plane.dot(p[v]) - plane.d;
            if (side < -error) continue;
            if (side > error || this->is_below(a, b, l, v)) break;
        }
        const bool found = v < n;
        const Vertex evaluated = v + found;
        counts_.evaluations += evaluated - this->members_of_plane(a, b, l, evaluated);
        patience_.ends(evaluated);
        return found;
    }
};

}  // namespace liftmesh::paper
