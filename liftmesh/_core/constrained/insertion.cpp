// An edge is found by turning around both of its ends at once, step by step: so the end with fewer
// neighbours decides how long it takes, and the spokes of a star cost no more than other edges.
// From there a walk along the edge collects the triangles that it crosses, to the first vertex that
// lies on it. What is left of these triangles are two pockets, left and right of the span. They
// take as many triangles as there were, in the same slots.
//
// An edge of the mesh that the span does not cross stays: a constraint only takes sight away, and
// so witnesses stay empty. Such an edge may have the cavity on both sides: then it is a side of the
// pocket twice.

#include "constrained/insertion.hpp"

#include "delaunay/divide_conquer.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::constrained {

// Turns counter-clockwise around a vertex until it finds the way to another one.
class Insertion::Turn {
 public:
    Turn(const Insertion& in, Vertex from, Vertex to)
        : in_(in), from_(from), to_(to), at_(in.ground_.corner[from]) {}

    // Looks at the next triangle. The edge is the one along the way, or the first that is crossed.
    Way step(Edge& found) {
        const Edge corner = at_;
        at_ = next(in_.twin(next(corner)));
        const Vertex p = in_.tail(corner), q = in_.head(corner);
        const int turn = p == ghost ? -1 : known_ ? turn_ : turn_to(p);
        const bool is_along = p == to_ || (turn == 0 && is_ahead(p));
        known_ = false;
        if (is_along) {
            found = previous(corner);
            return Way::along;
        }
        if (q == ghost) return Way::unknown;
        turn_ = turn_to(q);
        known_ = true;
        if (turn <= 0 || turn_ >= 0 || p == ghost) return Way::unknown;
        found = corner;
        return Way::across;
    }

 private:
    int turn_to(Vertex v) const { return orient2d(in_.at(from_), in_.at(v), in_.at(to_)); }

    // Of a vertex on the line.
    bool is_ahead(Vertex v) const {
        const Point from = in_.at(from_);
        return before_xy(from, in_.at(v)) == before_xy(from, in_.at(to_));
    }

    const Insertion& in_;
    Vertex from_, to_;
    Edge at_;
    int turn_ = 0;  // to the vertex that the next triangle has first
    bool known_ = false;
};

Insertion::Insertion(Construction& mesh, Mark* marks, Guard guard)
    : marks_(marks), guard_(guard), corner_(allocate<Edge>(mesh.count)) {
    ground_ = {mesh.points.get(), mesh.vertices.get(), mesh.twins.get(), corner_.get(), {}};
    const auto words = static_cast<Word>(words_per_triangle * (2 * mesh.count - 2));
    for (Edge e = 0; e < words; ++e)
        if (apex(e) != ghost) corner_[apex(e)] = e;
}

void Insertion::reserve(std::size_t triangles) {
    const std::size_t vertices = triangles + 2;  // of both chains, each end twice: two more
    cavity_.reserve(triangles);
    ground_.free.reserve(triangles);
    for (Chain* chain : {&left_, &right_}) {
        chain->pocket.reserve(vertices);
        chain->inner.reserve(vertices);
        chain->folds.reserve(vertices);
    }
}

// The first span from either end; the end from which it was found moves on.
Span Insertion::find_span(Vertex& a, Vertex& b) {
    Turn one(*this, a, b), other(*this, b, a);
    cavity_.clear();
    crossed_.clear();
    for (bool from_b = false;; from_b = !from_b) {
        Edge found = 0;
        const Way way = from_b ? other.step(found) : one.step(found);
        if (way == Way::unknown) continue;
        Vertex& from = from_b ? b : a;
        const Vertex begin = from;
        is_there_ = way == Way::along;
        along_ = found;
        from = is_there_ ? head(found) : cross(from, from_b ? a : b, found);
        return {begin, from};
    }
}

bool Insertion::mark_if_there(Vertex a, Vertex b) {
    Turn one(*this, a, b), other(*this, b, a);
    Edge found = 0;
    for (bool from_b = false;; from_b = !from_b) {
        const Way way = from_b ? other.step(found) : one.step(found);
        if (way == Way::unknown) continue;
        if (way == Way::across || head(found) != (from_b ? a : b)) return false;
        mark(found);
        mark(twin(found));
        return true;
    }
}

Span Insertion::insert_span(Vertex& a, Vertex& b) {
    const Span span = find_span(a, b);
    if (is_there_) {
        mark(along_);
        mark(twin(along_));
    } else if (crossed_.empty()) {
        cut_out();
    }
    return span;
}

// Walks along the way from a vertex, across edge after edge, to the first vertex on it.
Vertex Insertion::cross(Vertex from, Vertex to, Edge e) {
    const Point a = at(from), b = at(to);
    left_.begin(from);
    right_.begin(from);
    right_.add(tail(e), previous(e));
    left_.add(head(e), next(e));
    take(e);
    while (true) {
        if (is_marked(e)) crossed_.push_back(e);
        e = twin(e);
        take(e);
        const Vertex r = apex(e);
        const int turn = r == to ? 0 : orient2d(a, b, at(r));
        if (turn <= 0) right_.add(r, next(e));
        if (turn >= 0) left_.add(r, previous(e));
        if (turn == 0) return r;
        e = turn > 0 ? next(e) : previous(e);
    }
}

void Insertion::cut_out() {
    left_.pocket.reverse();
    std::reverse(left_.inner.begin(), left_.inner.end());
    for (const TriangleId t : cavity_) marks_[slot_of(t)] |= in_cavity;
    note_sides(left_);
    note_sides(right_);
    for (const TriangleId t : cavity_) marks_[slot_of(t)] = 0;
    ground_.free.assign(cavity_.rbegin(), cavity_.rend());
    fill(left_);
    fill(right_);
    const Edge base[2] = {left_.pocket.side(left_.inner.size()),
                          right_.pocket.side(right_.inner.size())};
    ground_.twins[base[0]] = base[1];
    ground_.twins[base[1]] = base[0];
    mark(base[0]);
    mark(base[1]);
}

// What is beyond the sides, which of them are marked, and which two are one edge. The triangles of
// the cavity are needed no more: the place of the opposite vertex holds the number of the side.
void Insertion::note_sides(Chain& chain) {
    chain.folds.clear();
    for (Word i = 0; i < chain.inner.size(); ++i) {
        const Edge e = chain.inner[i], beyond = twin(e);
        if (marks_[slot_of(triangle_of(beyond))] & in_cavity) {
            ground_.vertices[e] = i;
            chain.folds.push_back({i, 0});
        }
        chain.inner[i] = beyond | (is_marked(e) ? marked : 0);
    }
    for (Fold& each : chain.folds) each.other = ground_.vertices[chain.inner[each.side] & ~marked];
}

void Insertion::fill(Chain& chain) {
    chain.pocket.fill(ground_, guard_);
    for (const auto& [side, other] : chain.folds)
        chain.inner[side] = chain.pocket.side(other) | (chain.inner[side] & marked);
    for (std::size_t i = 0; i < chain.inner.size(); ++i) {
        const Edge side = chain.pocket.side(i), beyond = chain.inner[i] & ~marked;
        ground_.twins[side] = beyond;
        ground_.twins[beyond] = side;
        if (chain.inner[i] & marked) mark(side);
    }
}

}  // namespace liftmesh::constrained
