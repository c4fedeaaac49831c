// The circles that touch p and q are the points of a circle of directions, those from p. A disk d
// takes an open arc K(d) of them, from the circle p, q, d to that of q, p, d; infinity takes those
// that are none, and the rest is in one piece, and thus has an order. The dual of the edge leads
// from the end of K(s) to the beginning of K(r), neither of which is in K(infinity).
//
// Let neither be in the arc of the other disk, as must be. If K(r) and K(s) meet, then all that
// they leave is what leads from the end of K(s) to the beginning of K(r): forward, unless
// K(infinity) lies there, too. If K(infinity) meets one of them, then it does not lie there.
// Otherwise all three are disjoint, and their order decides.
//
// Where p, q, r and s touch one circle, arcs begin or end in common. Two that do both are the same
// arc, and meet.

#include "verify/disk_edge.hpp"

namespace liftmesh {

namespace {

using apollonius::Disk;
using apollonius::infinity;
using apollonius::Signs;

// One edge, where nothing is perturbed. Neither of r and s is infinity.
class Unperturbed {
 public:
    Unperturbed(const Signs& signs, const Disk& p, const Disk& q, const Disk& r, const Disk& s)
        : signs_(signs), p_(p), q_(q), r_(r), s_(s) {}

    bool leads_forward() const {
        return is_a_point() || meets_infinity(r_) || meets_infinity(s_) ||
               !(arcs_meet() || signs_.in_order(p_, q_, s_, infinity, r_));
    }

    bool arcs_meet() const {
        return r_ == s_ || signs_.distance_from(q_, p_, r_, s_) < 0 ||
               signs_.distance_from(p_, q_, s_, r_) < 0 || are_arcs_equal();
    }

 private:
    bool are_arcs_equal() const {
        return signs_.distance_from(p_, q_, r_, s_) == 0 &&
               signs_.distance_from(q_, p_, s_, r_) == 0 && !is_a_point();
    }
    bool is_a_point() const {
        return !(r_ == s_) && signs_.distance_from(p_, q_, r_, s_) == 0 &&
               signs_.touches_between(p_, q_, r_, s_);
    }
    bool meets_infinity(const Disk& d) const {
        return signs_.distance_from(p_, q_, infinity, d) < 0 ||
               signs_.distance_from(q_, p_, infinity, d) < 0;
    }

    const Signs& signs_;
    const Disk &p_, &q_, &r_, &s_;
};

// Whether t may be at one end and conflict with the circle at the other.
bool enters(const Signs& signs, const Disk& p, const Disk& q, const Disk& r, const Disk& t) {
    return !t.is_infinity && !(t == r) && signs.conflicts(p, q, r, t);
}
bool enters_exactly(const Signs& signs, const Disk& p, const Disk& q, const Disk& r,
                    const Disk& t) {
    return !t.is_infinity && !(t == r) && signs.distance_from(p, q, r, t) < 0;
}

}  // namespace

DiskEdge judge(const Signs& signs, const Disk& p, const Disk& q, const Disk& r, const Disk& s) {
    const bool is_ordered = p.is_infinity || q.is_infinity || r.is_infinity || s.is_infinity;
    const bool is_free = !enters(signs, p, q, r, s) && !enters(signs, q, p, s, r);
    if (is_free && (is_ordered || !signs.within_edge(p, q, r, s, infinity))) return DiskEdge::right;
    if (enters_exactly(signs, p, q, r, s) || enters_exactly(signs, q, p, s, r))
        return DiskEdge::entered;
    if (is_ordered || Unperturbed(signs, p, q, r, s).leads_forward()) return DiskEdge::tied;
    return DiskEdge::backwards;
}

bool holds_x_axis(const Signs& signs, const Disk& p, const Disk& r, const Disk& s) {
    if (signs.reaches_beyond(p, r) || signs.reaches_beyond(p, s)) return false;
    return Unperturbed(signs, p, infinity, r, s).arcs_meet() || signs.is_between(p, s, r);
}

}  // namespace liftmesh
