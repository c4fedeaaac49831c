// Procedure 3: LFRes(e, P), which is LF(e, P) with the restricted region.
#pragma once

#include <optional>

#include "paper/counts.hpp"
#include "paper/plane.hpp"
#include "paper/points.hpp"
#include "paper/region.hpp"
#include "status.hpp"

namespace liftmesh::paper {

class LfRes {
 public:
    LfRes(const LiftedPoints& points, Interrupt& interrupt) : p_(points), patience_(interrupt) {}

    std::optional<Vertex> operator()(Vertex a, Vertex b) {
        ++counts_.calls;
        const PlaneErrors errors(p_, a, b);
        const auto n = static_cast<Vertex>(p_.size());
        for (Vertex l = 0; l < n && !patience_.ends(); ++l) {          // lines 1, 12, 13
            if (l == a || l == b) continue;                            // lines 2, 3
            const Plane plane = plane_through(p_[a], p_[b], p_[l]);    // line 4
            if (!points_down(plane, errors, p_.planar(a), p_.planar(b), p_.planar(l)))
                continue;                                              // line 5
            ++counts_.candidate_planes;
            const Region region(plane, errors, p_.q(), p_.error_of_z());    // lines 6, 7
            if (!any_below(plane, region, errors.dot, a, b, l)) return l;   // lines 8 to 11
        }
        return std::nullopt;                                           // line 14
    }

    const Counts& counts() const { return counts_; }
    bool interrupted() { return patience_.ends(0); }

 private:
    bool any_below(const Plane& plane, const Region& region, double error, Vertex a, Vertex b,
                   Vertex l) {
        const auto n = static_cast<Vertex>(p_.size());
        auto& [i, ii, iii, iv, v, below] = counts_.rejected;
        Vertex k = 0;
        for (; k < n; ++k) {
            const SpacePoint& p = p_[k];
            if (p.z < region.min_z) {  // line 9
                ++below;
                break;
            }
            if (p.x < region.min_x) {  // line 10
                ++i;
            } else if (p.x > region.max_x) {
                ++ii;
            } else if (p.y < region.min_y) {
                ++iii;
            } else if (p.y > region.max_y) {
                ++iv;
            } else if (p.z > region.max_z) {
                ++v;
            } else {
                ++counts_.evaluations;
                const double side = plane.dot(p) - plane.d;
                if (side < -error) continue;
                if (side > error || is_below(a, b, l, k)) break;
            }
        }
        patience_.ends(k);
        return k < n;
    }

    bool is_below(Vertex a, Vertex b, Vertex l, Vertex v) {
        if (v == a || v == b || v == l) return false;
        ++counts_.undecided;
        return p_.is_below(a, b, l, v);
    }

    const LiftedPoints& p_;
    Patience patience_;
    Counts counts_;
};

}  // namespace liftmesh::paper
