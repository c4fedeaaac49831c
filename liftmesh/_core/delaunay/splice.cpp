// What is behind the chains of the seam is flooded, and its slots are filled again. The flood stops
// at the edges of the chains, and at the two vertices where the hull of the whole leaves that of a
// part: there the twins are cut first. Since it reaches dead triangles only, it marks without
// asking, and the list of what it found grows without a branch, which would be unpredictable.

#include "delaunay/regular_merge.hpp"

namespace liftmesh {

namespace {

class Splice {
 public:
    Splice(Mesh& mesh, FoundSeam& seam, FreeList free, TriangleId slot)
        : mesh_(mesh),
          seam_(seam),
          free_(free),
          dead_(seam.triangles.get_allocator()),
          lower_(slot),
          upper_(slot + words_per_triangle) {}

    FreeList run() {
        for (Side side : {on_left, on_right}) find_corners(side);
        cut_chains();
        flood();
        place_ghosts();
        for (std::uint32_t i = 0; i < seam_.triangles.size(); ++i) place(i);
        mesh_.join(mesh_.hull_edge(upper_), base_);
        return joined(mesh_, rest(), free_);
    }

 private:
    // The edges between ghosts at which the hull of the whole leaves that of a part, and comes
    // back. Both are at one gap if a single vertex of the part is left on the hull, or if all sites
    // are collinear and none is hidden.
    struct Corners {
        Edge kept_first, kept_last;
        bool all_die;    // no edge of the part is left on the hull
        bool ring_dies;  // some ghost dies
    };

    void find_corners(Side side) {
        Corners& at = corners_[side];
        const TriangleId first = seam_.first[side], last = seam_.last[side];
        at.kept_first = mesh_.twin(edge(first, side));
        at.kept_last = edge(last, side);
        at.all_die = first == last && (!seam_.triangles.empty() || seam_.has_passed[side]);
        at.ring_dies = at.all_die || first != last;
    }

    void cut_chains() {
        for (Side side : {on_left, on_right}) {
            const Corners& at = corners_[side];
            if (at.all_die || !at.ring_dies) continue;
            const Edge dead_last = mesh_.twin(at.kept_last);
            mesh_.cut(edge(seam_.first[side], side));
            mesh_.cut(dead_last);
        }
        for (std::uint32_t i = 0; i < seam_.triangles.size(); ++i) {
            SeamTriangle& t = seam_.triangles[i];
            mesh_.cut(t.behind);
            mesh_.name(t.behind, i);
            if (mesh_.is_cut(t.chain)) find_mate(t, i);
        }
    }

    // The chain has been here before, the other way: both sides of the edge are of the seam.
    void find_mate(SeamTriangle& t, std::uint32_t i) {
        t.mate = mesh_.apex(t.chain);
        seam_.triangles[t.mate].mate = i;
    }

    void flood() {
        dead_.resize(seam_.triangles.size() + 8);
        for (const SeamTriangle& t : seam_.triangles) kill(triangle_of(t.behind));
        for (Side side : {on_left, on_right})
            if (!seam_.has_moved[side] && corners_[side].ring_dies) kill(seam_.first[side]);
        for (std::size_t i = 0; i < killed_; ++i) {
            if (killed_ + 3 > dead_.size()) dead_.resize(2 * dead_.size());
            const TriangleId t = dead_[i];
            for (unsigned k = 0; k < 3; ++k) kill(triangle_of(mesh_.twin(t, k)));
        }
    }

    void kill(TriangleId t) {
        dead_[killed_] = t;
        killed_ += !is_dead(mesh_, t);
        mesh_.vertex(t, 1) = ghost;
    }

    // The dead slots that the seam leaves.
    FreeList rest() {
        FreeList list;
        for (std::size_t i = killed_; i > seam_.triangles.size(); --i) {
            bury(mesh_, dead_[i - 1], list.first);
            if (list.count++ == 0) list.last = dead_[i - 1];
            list.first = dead_[i - 1];
        }
        return list;
    }

    void place_ghosts() {
        mesh_.place_ghost(lower_, seam_.start[on_left], seam_.start[on_right]);
        mesh_.place_ghost(upper_, seam_.top[on_right], seam_.top[on_left]);
        for (Side side : {on_left, on_right}) {
            const Edge from_lower = edge(lower_, side), from_upper = edge(upper_, opposite(side));
            if (corners_[side].all_die) {
                mesh_.join(from_lower, from_upper);
            } else {
                mesh_.join(from_lower, corners_[side].kept_first);
                mesh_.join(from_upper, corners_[side].kept_last);
            }
        }
        base_ = mesh_.hull_edge(lower_);
        end_[on_left] = seam_.start[on_left];
        end_[on_right] = seam_.start[on_right];
    }

    void place(std::uint32_t i) {
        SeamTriangle& t = seam_.triangles[i];
        const TriangleId slot = i < killed_ ? dead_[i] : take();
        mesh_.vertex(slot, 0) = end_[on_left];
        mesh_.vertex(slot, 1) = end_[on_right];
        mesh_.vertex(slot, 2) = t.apex;
        mesh_.join(edge(slot, 2), base_);
        base_ = edge(slot, t.side);
        join_chain(t, i, edge(slot, opposite(t.side)));
        end_[t.side] = t.apex;
    }

    // Of two mates the first leaves a note where its edge is.
    void join_chain(SeamTriangle& t, std::uint32_t i, Edge mine) {
        if (t.mate == SeamTriangle::none) {
            mesh_.join(mine, t.chain);
        } else if (t.mate < i) {
            mesh_.join(mine, seam_.triangles[t.mate].chain);
        } else {
            t.chain = mine;
        }
    }

    TriangleId take() {
        const TriangleId slot = free_.first;
        free_.first = mesh_.vertex(slot, 0);
        --free_.count;
        if (free_.first == FreeList::none) free_.last = FreeList::none;
        return slot;
    }

    Mesh& mesh_;
    FoundSeam& seam_;
    FreeList free_;
    std::pmr::vector<TriangleId> dead_;  // the first `killed_`, and room
    std::size_t killed_ = 0;
    TriangleId lower_, upper_;
    Corners corners_[2];
    Vertex end_[2] = {};  // of the base
    Edge base_ = 0;
};

}  // namespace

FreeList joined(Mesh& mesh, FreeList first, FreeList second) {
    if (first.first == FreeList::none) return second;
    if (second.first == FreeList::none) return first;
    mesh.vertex(first.last, 0) = second.first;
    return {first.first, second.last, first.count + second.count};
}

FreeList splice(Mesh& mesh, FoundSeam& seam, FreeList free, TriangleId slot) {
    return Splice(mesh, seam, free, slot).run();
}

}  // namespace liftmesh
