// The merge step of divide and conquer (Lee and Schachter 1980, Guibas and Stolfi 1985), told on
// the lifted lower hull: the lower tangent is the first edge of the seam; then the plane through
// the base edge turns upward until it touches the next lifted point, left or right, which closes a
// triangle and gives the next base. Edges of either part whose two triangles are not lower facets
// any more are opened on the way: the triangle inside and the ghost outside become two ghosts.
//
// The code speaks of left, right, lower and upper as for a cut across the x axis. A cut across y is
// the same picture turned by a right angle, and no predicate notices.

#include "merge.hpp"

#include <cstddef>

#include "predicates/orient2d.hpp"
#include "predicates/sighting.hpp"

namespace liftmesh {

namespace {

// The hull vertex that no other precedes, as the ghost that leaves it. Along the hull the order has
// one maximum and one minimum, so climbing from anywhere reaches it; the better end of the last
// seam is mostly near.
template <class Precedes>
TriangleId climb(const Mesh& mesh, Part part, Precedes precedes) {
    const auto at = [&](TriangleId t) { return mesh.point(mesh.tail(t)); };
    TriangleId g = precedes(at(part.lower), at(part.upper)) ? part.upper : part.lower;
    Point here = at(g);
    for (TriangleId ahead = mesh.successor(g); precedes(here, at(ahead));
         ahead = mesh.successor(g)) {
        g = ahead;
        here = at(g);
    }
    for (TriangleId behind = mesh.predecessor(g); precedes(here, at(behind));
         behind = mesh.predecessor(g)) {
        g = behind;
        here = at(g);
    }
    return g;
}

class Merge {
 public:
    Merge(const Seam& seam, TriangleId slot)
        : mesh_(seam.mesh), guard_(seam.guard), interrupt_(seam.interrupt), slot_(slot) {}

    Part run(TriangleId left, TriangleId right) {
        find_lower_tangent(left, right);
        lay_first_base();
        rise();
        close();
        return {slot_, slot_ + 1};
    }

 private:
    Point at(Vertex v) const { return mesh_.point(v); }
    bool below(Point p) const { return orient2d(pa_, pb_, p) < 0; }
    bool above(Point p) const { return orient2d(pa_, pb_, p) > 0; }

    void set_a(Vertex v) {
        a_ = v;
        pa_ = at(v);
    }
    void set_b(Vertex v) {
        b_ = v;
        pb_ = at(v);
    }

    // From here on left_ is the ghost of the hull edge that leaves a, right_ of the one that
    // arrives at b: the two walls of the gap above the base a -> b.
    void find_lower_tangent(TriangleId left, TriangleId right) {
        set_a(mesh_.tail(left));
        set_b(mesh_.tail(right));
        for (;;) {
            if (below(at(mesh_.head(right)))) {
                set_b(mesh_.head(right));
                right = mesh_.successor(right);
            } else if (below(at(mesh_.tail(mesh_.predecessor(left))))) {
                left = mesh_.predecessor(left);
                set_a(mesh_.tail(left));
            } else {
                break;
            }
        }
        left_ = left;
        right_ = right;
    }

    void lay_first_base() {
        const TriangleId after = right_;
        right_ = mesh_.predecessor(right_);
        mesh_.place_ghost(slot_, a_, b_);
        mesh_.chain(mesh_.predecessor(left_), slot_);
        mesh_.chain(slot_, after);
        base_ = mesh_.hull_edge(slot_);
    }

    void rise() {
        for (Patience patience(interrupt_); !patience.ends();) {
            const Base base(pa_, pb_);
            const Vertex c = mesh_.head(left_), d = mesh_.tail(right_);
            Candidate l{c, at(c), base.sight(at(c))};
            Candidate r{d, at(d), base.sight(at(d))};
            const bool left = is_above(l);
            const bool right = is_above(r);
            if (!left && !right) return;
            if (left) open_left(base, l);
            if (right) open_right(base, r);
            if (left && !(right && in_circle(l, r))) {
                advance_left();
            } else {
                advance_right();
            }
        }
    }

    struct Candidate {
        Vertex vertex;
        Point point;
        Sighting sighting;
    };
    Candidate candidate(const Base& base, Vertex v) const {
        const Point p = at(v);
        return {v, p, base.sight(p)};
    }

    bool is_above(const Candidate& c) const {
        const Margin margin = distance(c.sighting);
        if (margin.value > margin.error + guard_.margin()) return true;
        if (-margin.value > margin.error + guard_.margin()) return false;
        return above(c.point);
    }

    bool in_circle(const Candidate& c, const Candidate& d) const {
        const Margin margin = liftmesh::below(c.sighting, d.sighting);
        if (margin.value > margin.error + guard_.margin()) return true;
        if (-margin.value > margin.error + guard_.margin()) return false;
        return incircle_canonical_exact(pa_, pb_, c.point, d.point, guard_) > 0;
    }

    // While the next point inward lies in the circle of the base and the candidate, the hull edge
    // to the candidate goes: a ghost each for the two other edges of the triangle behind it.
    void open_left(const Base& base, Candidate& c) {
        for (;;) {
            const Edge wall = mesh_.twin(mesh_.hull_edge(left_));
            const Vertex inward = mesh_.apex(wall);
            if (inward == ghost) return;
            const Candidate d = candidate(base, inward);
            if (!in_circle(c, d)) return;
            const TriangleId far = triangle_of(wall);
            const Edge near_side = mesh_.twin(previous(wall));
            const Edge far_side = mesh_.twin(next(wall));
            mesh_.place_ghost(far, d.vertex, c.vertex);
            mesh_.chain(far, mesh_.successor(left_));
            mesh_.join(mesh_.hull_edge(far), far_side);
            mesh_.place_ghost(left_, a_, d.vertex);
            mesh_.chain(left_, far);
            mesh_.join(mesh_.hull_edge(left_), near_side);
            c = d;
        }
    }

    void open_right(const Base& base, Candidate& c) {
        for (;;) {
            const Edge wall = mesh_.twin(mesh_.hull_edge(right_));
            const Vertex inward = mesh_.apex(wall);
            if (inward == ghost) return;
            const Candidate d = candidate(base, inward);
            if (!in_circle(c, d)) return;
            const TriangleId far = triangle_of(wall);
            const Edge near_side = mesh_.twin(next(wall));
            const Edge far_side = mesh_.twin(previous(wall));
            mesh_.place_ghost(far, c.vertex, d.vertex);
            mesh_.chain(mesh_.predecessor(right_), far);
            mesh_.join(mesh_.hull_edge(far), far_side);
            mesh_.place_ghost(right_, d.vertex, b_);
            mesh_.chain(far, right_);
            mesh_.join(mesh_.hull_edge(right_), near_side);
            c = d;
        }
    }

    // The ghost at the wall becomes the triangle of the base and the candidate.
    void advance_left() {
        const TriangleId filled = left_;
        left_ = mesh_.successor(filled);
        mesh_[filled].vertex[2] = b_;
        mesh_.join(edge(filled, 0), base_);
        base_ = edge(filled, 1);
        set_a(mesh_[filled].vertex[0]);
    }

    void advance_right() {
        const TriangleId filled = right_;
        right_ = mesh_.predecessor(filled);
        mesh_[filled].vertex[2] = a_;
        mesh_.join(edge(filled, 1), base_);
        base_ = edge(filled, 0);
        set_b(mesh_[filled].vertex[1]);
    }

    void close() {
        const TriangleId top = slot_ + 1;
        mesh_.place_ghost(top, b_, a_);
        mesh_.chain(right_, top);
        mesh_.chain(top, left_);
        mesh_.join(mesh_.hull_edge(top), base_);
    }

    Mesh& mesh_;
    Guard guard_;
    Interrupt& interrupt_;
    TriangleId slot_;
    TriangleId left_ = 0, right_ = 0;
    Edge base_ = 0;
    Vertex a_ = 0, b_ = 0;
    Point pa_{}, pb_{};
};

}  // namespace

Part merge(const Seam& seam, Part left, Part right, Axis axis, TriangleId slot) {
    const auto ahead = [axis](Point p, Point q) { return before(axis, p, q); };
    const auto back = [axis](Point p, Point q) { return before(axis, q, p); };
    return Merge(seam, slot).run(climb(seam.mesh, left, ahead), climb(seam.mesh, right, back));
}

}  // namespace liftmesh
