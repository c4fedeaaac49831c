// Merges two adjacent regular triangulations along their seam. Unlike Delaunay's, this merge can
// hide vertices of either part, inside it and on its hull; so it first finds the seam on the two
// undisturbed parts, then removes what is behind it, then fills the gap. While neither part hides a
// site, most merges hide none either: so Delaunay's, which takes two thirds of the time, is tried
// first.
#pragma once

#include "base/status.hpp"
#include "delaunay/merge.hpp"
#include "delaunay/mesh.hpp"
#include "predicates/lifted_side.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/seen_from_base.hpp"

namespace liftmesh {

// What a merge that can hide no site does where sites may be hidden: it watches for the first sign
// of one, and can be undone.
//
// A candidate that is not to the left of the base is far from it, as beyond the end of a hull, or
// covered by a triangle of the seam. It is far only if a gap of the hull comes before it at this
// end, and if it has not been to the left of an earlier base of this end. A covered candidate means
// that a site is hidden: ARCHITECTURE.md, "Weighted points", has the proof.

class MayHide {
 public:
    explicit MayHide(std::pmr::memory_resource* memory) : saved_(memory) { saved_.reserve(128); }

    // To be called before a slot changes. Where it comes back its neighbours name it again; so a
    // neighbour that changes in nothing else need not be saved: of each link that changes one end
    // was saved with it, as a ghost is saved when it becomes the wall.
    void save(const Mesh& mesh, TriangleId t) {
        saved_.push_back({t,
                          {mesh.vertex(t, 0), mesh.vertex(t, 1), mesh.vertex(t, 2)},
                          {mesh.twin(t, 0), mesh.twin(t, 1), mesh.twin(t, 2)}});
    }

    // The latest first: what a slot was at first is put back last.
    void undo(Mesh& mesh) {
        for (; !saved_.empty(); saved_.pop_back()) {
            const Slot& slot = saved_.back();
            for (unsigned k = 0; k < words_per_triangle; ++k) {
                mesh.vertex(slot.triangle, k) = slot.vertices[k];
                mesh.join(edge(slot.triangle, k), slot.twins[k]);
            }
        }
    }

    // The edge to the candidate is opened: one hull vertex more comes next.
    void open(Side side) { ++opened_[side]; }

    // The end moves on to the next hull vertex. No gap is left there if it was a vertex inside.
    void advance(Side side) {
        may_be_far_[side] = opened_[side] == 0;
        opened_[side] -= opened_[side] > 0;
    }

    bool is_covered(Side side, bool is_above) {
        const bool is_far = may_be_far_[side];
        may_be_far_[side] = is_far & !is_above;
        return !is_above & !is_far;
    }

 private:
    struct Slot {
        TriangleId triangle;
        Vertex vertices[words_per_triangle];
        Edge twins[words_per_triangle];
    };

    std::pmr::vector<Slot> saved_;
    bool may_be_far_[2] = {true, true};  // the candidate
    Word opened_[2] = {0, 0};            // vertices that come next and were inside the hull
};

// Puts a seam in the place of the triangles that it replaces.

// `slot` is the first of the two slots of the merge: they become the ghosts of the two tangents.
// Takes dead slots from `free`, and returns those that remain.
FreeList splice(Mesh& mesh, FoundSeam& seam, FreeList free, TriangleId slot);

FreeList joined(Mesh& mesh, FreeList first, FreeList second);

// No triangle, and no ghost, has `ghost` at place 1.
inline bool is_dead(const Mesh& mesh, TriangleId t) {
    return mesh.vertex(t, 1) == ghost;
}
// The slot holds no triangle from now on. To a compaction it looks like a ghost.
inline void bury(Mesh& mesh, TriangleId t, TriangleId next) {
    mesh.vertex(t, 0) = next;
    mesh.vertex(t, 1) = mesh.vertex(t, 2) = ghost;
}

// Finds the seam of two regular triangulations that a cut separates, and changes neither.
//
// The lower tangent is the first base; then the plane through the base turns upward until it
// touches the next lifted point, one of the neighbours that the ends of the base have in their
// parts. A probe on either side stands at the lowest neighbour so far and moves on around the end
// of the base, counter-clockwise on the left. It never goes back: ARCHITECTURE.md, "Weighted
// points", has the proof.

template <class Lift>
struct LiftedMesh {
    Mesh mesh;
    const typename Lift::Value* values;
    Lift lift;
    Guard guard;
};

template <class Lift>
class SeamWalk {
 public:
    SeamWalk(const LiftedMesh<Lift>& lifted, const Certainty& certainty, Interrupt& interrupt,
             FoundSeam& seam)
        : lifted_(lifted),
          mesh_(lifted.mesh),
          certainty_(certainty),
          interrupt_(interrupt),
          seam_(seam) {}

    // From the ghosts that leave the hull vertices next to the cut.
    void run(TriangleId from_left, TriangleId from_right) {
        find_first_base(from_left, from_right);
        rise();
        for (Side side : {on_left, on_right}) {
            seam_.top[side] = end_[side].vertex;
            seam_.last[side] = probe_[side].gap;
        }
    }

 private:
    using Value = typename Lift::Value;
    using Place = typename LiftedBase<Lift>::Place;

    struct Corner {
        Vertex vertex;
        Pair at;
        Value value;
    };

    // The neighbours of an end of the base before this one are done with. One beyond a gap of the
    // hull that is not to the left of the base is far, others are covered.
    struct Probe {
        Edge edge;  // between the end and the neighbour, in the triangle that follows
        bool is_beyond_gap;
        Corner corner;   // the neighbour
        TriangleId gap;  // the ghost that follows the last gap
    };

    Corner corner(Vertex v) const { return {v, mesh_.at(v), lifted_.values[v]}; }
    static Lifted<Lift> site(const Corner& c) { return {point(c.at), c.value}; }

    // The first base: the lower common tangent. On the tangent line itself, an end that is hidden
    // by the segment from its successor to the other end is left as well.
    void find_first_base(TriangleId from_left, TriangleId from_right) {
        TriangleId l = from_left, r = from_right;
        end_[on_left] = corner(mesh_.tail(l));
        end_[on_right] = corner(mesh_.tail(r));
        for (;;) {
            const Corner ahead = corner(mesh_.head(r));
            if (is_passed<on_right>(ahead)) {
                end_[on_right] = ahead;
                seam_.has_passed[on_right] = true;
                r = mesh_.successor(r);
                continue;
            }
            const TriangleId before = mesh_.predecessor(l);
            const Corner behind = corner(mesh_.tail(before));
            if (!is_passed<on_left>(behind)) break;
            end_[on_left] = behind;
            seam_.has_passed[on_left] = true;
            l = before;
        }
        start_probe<on_left>(l, mesh_.head(l));
        const TriangleId arriving = mesh_.predecessor(r);
        start_probe<on_right>(arriving, mesh_.tail(arriving));
    }

    // Whether the end gives way to the next hull vertex.
    template <Side side>
    bool is_passed(const Corner& next) const {
        const Pair across = end_[on_right].at - end_[on_left].at, to = next.at - end_[on_left].at;
        const Pair product = across * swapped(to);
        const double distance = product[0] - product[1];
        if (std::fabs(distance) > certainty_.of_distance) [[likely]]
            return distance < 0;
        return is_passed_in_doubt<side>(next);
    }

    template <Side side>
    [[gnu::cold, gnu::noinline]] bool is_passed_in_doubt(const Corner& next) const {
        const Lifted<Lift> from = site(next), at = site(end_[side]);
        const Lifted<Lift> to = site(end_[opposite(side)]);
        const int turn =
            orient2d(site(end_[on_left]).point, site(end_[on_right]).point, from.point);
        if (turn != 0) return turn < 0;
        return is_between_and_hidden(lifted_.lift, from, at, to);
    }

    template <Side side>
    void start_probe(TriangleId wall, Vertex neighbor) {
        seam_.start[side] = end_[side].vertex;
        seam_.first[side] = wall;
        probe_[side] = {mesh_.twin(mesh_.hull_edge(wall)), false, corner(neighbor), wall};
    }

    void rise() {
        for (Patience patience(interrupt_); !patience.ends();) {
            base_ = LiftedBase<Lift>(end_[on_left].at, end_[on_left].value, end_[on_right].at,
                                     end_[on_right].value);
            Place c, d;
            const bool has_left = find_lowest<on_left>(c), has_right = find_lowest<on_right>(d);
            if (!has_left && !has_right) return;
            if (has_left &&
                !(has_right && is_below(probe_[on_left].corner, c, probe_[on_right].corner, d))) {
                advance<on_left>();
            } else {
                advance<on_right>();
            }
        }
    }

    template <Side side>
    bool find_lowest(Place& place) {
        Probe& probe = probe_[side];
        if (!leave_covered<side>(probe, place)) return false;
        descend<side>(probe, place);
        return true;
    }

    // Moves on to the first neighbour to the left of the base, seen along it; false if there is
    // none.
    template <Side side>
    bool leave_covered(Probe& probe, Place& place) {
        for (;;) {
            place = base_.place(probe.corner.at, probe.corner.value);
            if (is_above(place, probe.corner)) {
                probe.is_beyond_gap = false;
                return true;
            }
            if (probe.is_beyond_gap) return false;
            turn<side>(probe);
        }
    }

    bool is_above(const Place& place, const Corner& c) const {
        if (std::fabs(place.distance()) > certainty_.of_distance) [[likely]]
            return place.distance() > 0;
        return is_left_in_doubt(c);
    }

    [[gnu::cold, gnu::noinline]] bool is_left_in_doubt(const Corner& c) const {
        return orient2d(point(end_[on_left].at), point(end_[on_right].at), point(c.at)) > 0;
    }

    // On to the next neighbour, if need be over a gap of the hull: without a branch, which would be
    // unpredictable.
    template <Side side>
    void turn(Probe& probe) const {
        const Edge near = mesh_.twin(far_edge<side>(probe.edge));
        const Edge beyond = mesh_.twin(far_edge<side>(near));
        const bool is_gap = mesh_.apex(far_edge<side>(near)) == ghost;
        probe.gap = is_gap ? triangle_of(near) : probe.gap;
        probe.edge = is_gap ? beyond : near;
        probe.corner = corner(mesh_.apex(far_edge<side>(probe.edge)));
        probe.is_beyond_gap = is_gap;
    }

    // In the triangle of an edge at the end, the other edge there.
    template <Side side>
    static Edge far_edge(Edge e) {
        return side == on_left ? previous(e) : next(e);
    }

    // On to the next neighbour as long as it is lower. Beyond the hull there is none.
    template <Side side>
    void descend(Probe& probe, Place& place) {
        for (;;) {
            const Vertex v = mesh_.apex(probe.edge);
            if (v == ghost) return;
            const Corner behind = corner(v);
            const Place there = base_.place(behind.at, behind.value);
            if (!is_below(probe.corner, place, behind, there)) return;
            probe.edge = mesh_.twin(far_edge<side>(probe.edge));
            probe.corner = behind;
            place = there;
        }
    }

    // Whether the lift of d is below the plane through the base and the lift of c.
    bool is_below(const Corner& c, const Place& place_of_c, const Corner& d,
                  const Place& place_of_d) const {
        const double value = base_.below(place_of_c, place_of_d);
        if (std::fabs(value) > certainty_.of_circle) [[likely]]
            return value > 0;
        return is_below_in_doubt(c, d, value);
    }

    [[gnu::cold, gnu::noinline]] bool is_below_in_doubt(const Corner& c, const Corner& d,
                                                        double value) const {
        const double error =
            base_.error_of_below(c.at, c.value, d.at, d.value) + lifted_.guard.margin();
        if (std::fabs(value) > error) return value > 0;
        return lifted_side_canonical_exact(lifted_.lift, site(end_[on_left]), site(end_[on_right]),
                                           site(c), site(d), lifted_.guard) > 0;
    }

    // The end moves on to the lowest neighbour. Around the new end, what comes before the edge
    // back is done with.
    template <Side side>
    void advance() {
        Probe& probe = probe_[side];
        const Edge behind = mesh_.twin(probe.edge);
        seam_.triangles.push_back({probe.corner.vertex, side, probe.edge, behind});
        seam_.has_moved[side] = true;
        end_[side] = probe.corner;
        probe.edge = behind;
        turn<side>(probe);
    }

    const LiftedMesh<Lift>& lifted_;
    Mesh mesh_;
    Certainty certainty_;
    Interrupt& interrupt_;
    FoundSeam& seam_;
    LiftedBase<Lift> base_;
    Corner end_[2];  // of the base
    Probe probe_[2];
};

// A finished part, and its slots without a triangle.
struct RegularPart : Part {
    FreeList free;
};

// Merges parts that a cut across `axis` separates, as `merge` does: it writes the triangle slots of
// both parts, `slot` and the one after it, and nothing else.
template <class Lift>
RegularPart regular_merge(const LiftedMesh<Lift>& lifted, const Certainty& certainty,
                          Interrupt& interrupt, const RegularPart& first, const RegularPart& second,
                          Axis axis, TriangleId slot) {
    Mesh mesh = lifted.mesh;
    std::byte room[8192];
    std::pmr::monotonic_buffer_resource memory(room, sizeof room);
    if (first.free.count + second.free.count == 0) {
        MayHide hiding(&memory);
        OnePassMerge<Lift, MayHide> merge(lifted.lift, {mesh, lifted.guard, interrupt},
                                          lifted.values, certainty, slot, hiding);
        if (merge.run(first, second, axis)) return {merge.part(axis), {}};
        hiding.undo(mesh);
    }
    FoundSeam seam{std::pmr::vector<SeamTriangle>(&memory)};
    seam.triangles.reserve(64);
    SeamWalk<Lift>(lifted, certainty, interrupt, seam)
        .run(leaving_last(mesh, first, axis), leaving_first(mesh, second, axis));
    const FreeList free = splice(mesh, seam, joined(mesh, first.free, second.free), slot);
    return {{slot, slot + words_per_triangle, axis}, free};
}

}  // namespace liftmesh
