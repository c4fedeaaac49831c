// The merge step of divide and conquer (Lee and Schachter 1980, Guibas and Stolfi 1985), on
// the lifted lower hull: the lower tangent is the first edge of the seam; then the plane through
// the base edge turns upward until it touches the next lifted point, left or right, which closes a
// triangle and gives the next base. Edges of either part whose two triangles are no longer lower
// facets are opened on the way: the triangle inside and the ghost outside become two ghosts.
//
// The names left, right, lower and upper are for a cut across the x axis. A cut across y is the
// same configuration rotated by a right angle, which changes no predicate.

#include "delaunay/merge.hpp"

#include "predicates/orient2d.hpp"
#include "predicates/sighting.hpp"

namespace liftmesh {

namespace {

// The ghost that leaves the hull vertex that is last in the order of `precedes`. Along the hull the
// order has one maximum and one minimum, so climbing from anywhere reaches it; the better end of
// the last seam is usually close.
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

// The left part and the right one. The steps on one side mirror those on the other, with clockwise
// and counter-clockwise exchanged, so that both share the same code.
using Side = unsigned;
constexpr Side left = 0, right = 1;

constexpr Side opposite(Side side) {
    return 1 - side;
}

class Merge {
 public:
    Merge(const Seam& seam, TriangleId slot)
        : mesh_(seam.mesh), guard_(seam.guard), interrupt_(seam.interrupt), slot_(slot) {}

    Part run(TriangleId from_left, TriangleId from_right) {
        find_lower_tangent(from_left, from_right);
        lay_first_base();
        rise();
        close();
        return {slot_, top()};
    }

 private:
    // A vertex that may close a triangle with the base.
    struct Candidate {
        Vertex vertex;
        Point point;
        Sighting sighting;
    };

    Point at(Vertex v) const { return mesh_.point(v); }
    Candidate candidate(const Base& base, Vertex v) const {
        const Point p = at(v);
        return {v, p, base.sight(p)};
    }
    // The second of the two triangles that the merge adds.
    TriangleId top() const { return slot_ + words_per_triangle; }

    void set_end(Side side, Vertex v) {
        end_[side] = v;
        point_[side] = at(v);
    }

    // Afterwards the walls are the ghosts of the two hull edges that meet the base from above:
    // the one that leaves its left end, and the one that arrives at its right end.
    void find_lower_tangent(TriangleId from_left, TriangleId from_right) {
        wall_[left] = from_left;
        wall_[right] = from_right;
        set_end(left, mesh_.tail(from_left));
        set_end(right, mesh_.tail(from_right));
        const auto is_below = [&](Vertex v) {
            return orient2d(point_[left], point_[right], at(v)) < 0;
        };
        for (;;) {
            if (const Vertex v = mesh_.head(wall_[right]); is_below(v)) {
                set_end(right, v);
                wall_[right] = mesh_.successor(wall_[right]);
            } else if (const Vertex w = mesh_.tail(mesh_.predecessor(wall_[left])); is_below(w)) {
                wall_[left] = mesh_.predecessor(wall_[left]);
                set_end(left, w);
            } else {
                return;
            }
        }
    }

    void lay_first_base() {
        const TriangleId after = wall_[right];
        wall_[right] = mesh_.predecessor(after);
        mesh_.place_ghost(slot_, end_[left], end_[right]);
        mesh_.chain(mesh_.predecessor(wall_[left]), slot_);
        mesh_.chain(slot_, after);
        base_ = mesh_.hull_edge(slot_);
    }

    // In a wall the candidate stands at place `side`, the end of the base at the other.
    void rise() {
        for (Patience patience(interrupt_); !patience.ends();) {
            const Base base(point_[left], point_[right]);
            Candidate c = candidate(base, mesh_.apex(edge(wall_[left], left)));
            Candidate d = candidate(base, mesh_.apex(edge(wall_[right], right)));
            const bool left_is_above = is_above(c);
            const bool right_is_above = is_above(d);
            if (!left_is_above && !right_is_above) return;
            if (left_is_above) open<left>(base, c);
            if (right_is_above) open<right>(base, d);
            if (left_is_above && !(right_is_above && is_below(c, d))) {
                advance<left>();
            } else {
                advance<right>();
            }
        }
    }

    bool is_above(const Candidate& c) const {
        const Margin margin = distance(c.sighting);
        const double error = margin.error + guard_.margin();
        if (margin.value > error) return true;
        if (-margin.value > error) return false;
        return orient2d(point_[left], point_[right], c.point) > 0;
    }

    // Whether the lift of d is below the plane through the base and the lift of c.
    bool is_below(const Candidate& c, const Candidate& d) const {
        const Margin margin = below(c.sighting, d.sighting);
        const double error = margin.error + guard_.margin();
        if (margin.value > error) return true;
        if (-margin.value > error) return false;
        return incircle_canonical_exact(point_[left], point_[right], c.point, d.point, guard_) > 0;
    }

    // While the next point inward is below the plane of the base and the candidate, the hull edge
    // to the candidate is removed: the two other edges of the triangle behind it get a ghost each.
    template <Side side>
    void open(const Base& base, Candidate& c) {
        const TriangleId wall = wall_[side];
        for (;;) {
            const Edge inner = mesh_.twin(mesh_.hull_edge(wall));
            const Vertex apex = mesh_.apex(inner);
            if (apex == ghost) return;
            const Candidate d = candidate(base, apex);
            if (!is_below(c, d)) return;
            const TriangleId far = triangle_of(inner);
            const Edge near_edge = mesh_.twin(side == left ? previous(inner) : next(inner));
            const Edge far_edge = mesh_.twin(side == left ? next(inner) : previous(inner));
            mesh_.vertex(far, side) = c.vertex;
            mesh_.vertex(far, opposite(side)) = d.vertex;
            mesh_.vertex(far, 2) = ghost;
            mesh_.join(edge(far, opposite(side)), mesh_.twin(edge(wall, opposite(side))));
            mesh_.join(mesh_.hull_edge(far), far_edge);
            mesh_.vertex(wall, side) = d.vertex;
            mesh_.join(edge(wall, opposite(side)), edge(far, side));
            mesh_.join(mesh_.hull_edge(wall), near_edge);
            c = d;
        }
    }

    // The ghost at the wall becomes the triangle of the base and the candidate.
    template <Side side>
    void advance() {
        const TriangleId filled = wall_[side];
        wall_[side] = mesh_.twin(edge(filled, opposite(side))) - side;
        mesh_.vertex(filled, 2) = end_[opposite(side)];
        mesh_.join(edge(filled, side), base_);
        base_ = edge(filled, opposite(side));
        set_end(side, mesh_.apex(edge(filled, side)));
    }

    void close() {
        mesh_.place_ghost(top(), end_[right], end_[left]);
        mesh_.chain(wall_[right], top());
        mesh_.chain(top(), wall_[left]);
        mesh_.join(mesh_.hull_edge(top()), base_);
    }

    Mesh& mesh_;
    Guard guard_;
    Interrupt& interrupt_;
    TriangleId slot_;
    TriangleId wall_[2] = {};
    Vertex end_[2] = {};  // of the base, and where they are
    Point point_[2] = {};
    Edge base_ = 0;
};

}  // namespace

Part merge(const Seam& seam, Part first, Part second, Axis axis, TriangleId slot) {
    const auto ahead = [axis](Point p, Point q) { return before(axis, p, q); };
    const auto back = [axis](Point p, Point q) { return before(axis, q, p); };
    return Merge(seam, slot).run(climb(seam.mesh, first, ahead), climb(seam.mesh, second, back));
}

}  // namespace liftmesh
