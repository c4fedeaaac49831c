// Procedure 3: LFRes(e, P), which is LF(e, P) with the restricted region.
#pragma once

#include <algorithm>
#include <optional>

#include "paper/facet_search.hpp"
#include "paper/plane.hpp"
#include "paper/region.hpp"

namespace liftmesh::paper {

class LfRes : public FacetSearch<LiftedPoints> {
 public:
    using FacetSearch::FacetSearch;

    std::optional<Vertex> operator()(Vertex a, Vertex b) {
        ++counts_.calls;
        const PlaneErrors errors(p_, a, b);
        const auto n = static_cast<Vertex>(p_.size());
        for (Vertex l = 0; l < n && !patience_.ends(); ++l) {        // lines 1, 12, 13
            if (l == a || l == b) continue;                          // lines 2, 3
            const Plane plane = plane_through(p_[a], p_[b], p_[l]);  // line 4
            if (!points_down(plane, errors, p_.planar(a), p_.planar(b), p_.planar(l)))
                continue;  // line 5
            ++counts_.candidate_planes;
            const Region region(plane, errors, p_.q(), p_.error_of_z());   // lines 6, 7
            if (!any_below(plane, region, errors.dot, a, b, l)) return l;  // lines 8 to 11
        }
        return std::nullopt;  // line 14
    }

 private:
    bool any_below(const Plane& plane, const Region& region, double error, Vertex a, Vertex b,
                   Vertex l) {
        const SpacePoint* const p = p_.data();
        const auto n = static_cast<Vertex>(p_.size());
        Vertex k = 0, evaluated = 0;
        for (;; ++k) {
            k = next_in_region(p, k, n, region, counts_.rejected);
            if (k == n || p[k].z < region.min_z) break;  // line 9
            ++evaluated;
            const double side = plane.dot(p[k]) - plane.d;  // line 10
            if (side < -error) continue;
            if (side > error || is_below(a, b, l, k)) break;
        }
        counts_.evaluations += evaluated - members_of_plane(a, b, l, std::min(k + 1, n));
        patience_.ends(k);
        return k < n;
    }
};

}  // namespace liftmesh::paper
