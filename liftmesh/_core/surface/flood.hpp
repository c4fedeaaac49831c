// The pairs of faces of two triangulations that touch each other, by a flood: for each face of one
// all of the other that touch it are found, across every side that touches it, too. Triangulations
// cover convex regions, so what touches a face is connected, and so are the faces that touch the
// other region: each hands the next one a face to begin with. Whether a side touches a face is
// decided by exact orientations. So no pair is missed, and one that is found needlessly has no
// area. Once two faces overlap, sides count that have more than a point in common with a face: what
// overlaps a face is connected through them, too, and all faces at a vertex of both are not paired.
#pragma once

#include "surface/face_pair.hpp"

namespace liftmesh {

// A face of the first, and one of the second with which its visit begins.
struct FloodStart {
    std::int32_t face, other;
};

// `Meshes` has face(mesh, number) and neighbor(mesh, number, face, side), where `mesh` is 0 or 1,
// goes_on(tail, head), whether to cross a side of the first, is_whole(), whether it always does,
// and visit(number, other, pair).
template <class Meshes>
class Flood {
 public:
    // `start` has `unvisited` for each face of the first. Floods may share it that visit
    // different ones.
    Flood(Meshes& meshes, std::vector<std::int32_t>& start, std::size_t second, Patience& patience)
        : meshes_(meshes), patience_(patience), start_(start), last_(start.size()), seen_(second) {}

    static constexpr std::int32_t unvisited = -1;

    // From two faces that touch; stops if the patience ends.
    void run(std::int32_t face, std::int32_t other) {
        if (const auto found = overlap(face, other)) {
            overlaps_ = true;
            begin(found->face, found->other);
            drain();
        }
    }

    // The first two faces that overlap. If floods are not whole, there are none, and all is
    // visited. At a vertex that both have, all faces of one touch all of the other: where none of
    // its faces overlaps the first face, looking at each would take the product of their numbers.
    std::optional<FloodStart> overlap(std::int32_t face, std::int32_t other) {
        overlaps_ = false;
        overlap_.reset();
        if (meshes_.is_whole()) look_around(face, other);
        if (overlap_) return overlap_;
        begin(face, other);
        drain();
        if (overlap_) forget();
        return overlap_;
    }

    // From several pairs in a stretch of the first, once there is an overlap; `beyond` takes those
    // of other stretches.
    void run(std::span<const FloodStart> starts, std::size_t first, std::size_t last,
             std::vector<FloodStart>& beyond) {
        overlaps_ = true;
        first_ = first;
        last_ = last;
        beyond_ = &beyond;
        for (const auto& [face, other] : starts)
            if (is_new(face)) begin(face, other);
        drain();
        begun_.clear();
    }

    // Forgets which faces of the first were visited since it was last asked.
    void forget() {
        for (const std::int32_t each : begun_) start_[static_cast<std::size_t>(each)] = unvisited;
        begun_.clear();
    }

 private:
    void begin(std::int32_t face, std::int32_t other) {
        start_[static_cast<std::size_t>(face)] = other;
        pending_.push_back(face);
        begun_.push_back(face);
    }

    void drain() {
        while (!pending_.empty() && !patience_.ends()) {
            const std::int32_t next = pending_.back();
            pending_.pop_back();
            visit(next);
        }
        pending_.clear();
    }

    // The face of the first that overlaps one of the second, from one on that touches it.
    void look_around(std::int32_t face, std::int32_t other) {
        const Face over = meshes_.face(1, other);
        begin(face, other);
        while (!overlap_ && !pending_.empty() && !patience_.ends(16)) {
            const std::int32_t number = pending_.back();
            pending_.pop_back();
            const Face own = meshes_.face(0, number);
            const FacePair pair(own, over, meshes_.nearness());
            if (pair.overlap()) overlap_ = {number, other};
            for (std::size_t side = 0; side < 3; ++side) {
                const std::int32_t next = meshes_.neighbor(0, number, own, side);
                if (next >= 0 && is_new(next) && pair.touches(0, side)) begin(next, other);
            }
        }
        pending_.clear();
        forget();
    }

    bool is_new(std::int32_t face) const {
        return start_[static_cast<std::size_t>(face)] == unvisited;
    }
    bool is_own(std::int32_t face) const {
        return first_ <= static_cast<std::size_t>(face) && static_cast<std::size_t>(face) < last_;
    }

    bool is_met(const FacePair& pair, std::size_t face, std::size_t side) const {
        return overlaps_ ? pair.meets(face, side) : pair.touches(face, side);
    }

    // All faces of the second that touch a face of the first.
    void visit(std::int32_t number) {
        const Face face = meshes_.face(0, number);
        ++visits_;
        reached_.assign(1, start_[static_cast<std::size_t>(number)]);
        seen_[static_cast<std::size_t>(reached_[0])] = visits_;
        while (!reached_.empty() && !patience_.ends(16)) {
            const std::int32_t other = reached_.back();
            reached_.pop_back();
            const Face over = meshes_.face(1, other);
            const FacePair pair(face, over, meshes_.nearness());
            if (!overlaps_ && meshes_.is_whole() && pair.overlap()) {
                overlap_ = {number, other};
                pending_.clear();
                return;
            }
            meshes_.visit(number, other, pair);
            for (std::size_t side = 0; side < 3; ++side) {
                hand_on(meshes_.neighbor(0, number, face, side), other, pair, side);
                reach(meshes_.neighbor(1, other, over, side), pair, side);
            }
        }
    }

    void reach(std::int32_t next, const FacePair& pair, std::size_t side) {
        if (next < 0 || seen_[static_cast<std::size_t>(next)] == visits_) return;
        if (!is_met(pair, 1, side)) return;
        seen_[static_cast<std::size_t>(next)] = visits_;
        reached_.push_back(next);
    }

    // The next face of the first begins with the same one, if that touches the side between.
    void hand_on(std::int32_t next, std::int32_t other, const FacePair& pair, std::size_t side) {
        if (next < 0 || (is_own(next) && !is_new(next)) || !is_met(pair, 0, side)) return;
        const Face& face = pair.face(0);
        if (!meshes_.goes_on(face.at(tail_of(side)), face.at(head_of(side)))) return;
        if (is_own(next))
            begin(next, other);
        else
            beyond_->push_back({next, other});
    }

    Meshes& meshes_;
    Patience& patience_;
    std::vector<std::int32_t>& start_;   // for each face of the first, one of the second
    std::size_t first_ = 0, last_;       // of the first, that are visited
    std::vector<FloodStart>* beyond_{};  // for the others, if there are any
    std::vector<std::int64_t> seen_;     // for each of the second, the visit that reached it last
    std::int64_t visits_ = 0;
    bool overlaps_ = false;  // two faces that were found
    std::optional<FloodStart> overlap_;
    std::vector<std::int32_t> pending_, reached_, begun_;
};

}  // namespace liftmesh
