// Samples in lists, one for each triangle of the approximation. A sample on an edge is in the list
// of either side.
#pragma once

#include "base/buffer.hpp"
#include "base/status.hpp"
#include "dynamic/triangulation.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

class Lists {
 public:
    explicit Lists(const Terrain& terrain) : turns_(terrain) {}

    // In the order of a Hilbert curve and, within its cells, of their coordinates; false if
    // interrupted.
    bool fill(const Terrain& terrain, Interrupt& interrupt);

    const Turns& turns() const { return turns_; }
    std::size_t count() const { return entries_.size(); }
    Sample at(std::uint32_t s) const { return entries_[s].sample; }
    Row row(std::uint32_t s) const { return entries_[s].row; }
    std::vector<std::uint32_t> of_rows(const std::vector<Row>& rows) const;

    // Every sample that is no vertex, in its triangle; false if interrupted.
    bool deal(const dynamic::Triangulation& mesh, Interrupt& interrupt);
    // No list has a sample.
    void clear(const dynamic::Triangulation& mesh) {
        first_.assign(slot_of(mesh.slots().end()), none);
    }

    // Around an insertion: before the cavity is filled, and afterwards for the star.
    void release(const dynamic::Triangulation& mesh);
    void settle(const dynamic::Triangulation& mesh, std::uint32_t inserted);
    // Around a removal: before the star is replaced, and afterwards for the patch.
    void release(const dynamic::Star& star, std::uint32_t removed);
    void settle(const dynamic::Triangulation& mesh, const dynamic::Patch& patch,
                const std::vector<TriangleId>& made);

    bool is_before(std::uint32_t s, std::uint32_t other) const {
        return before_xy(entries_[s].sample.point, entries_[other].sample.point);
    }

    // Brings one of them.
    [[gnu::always_inline]] void prefetch(std::uint32_t s) const {
        liftmesh::prefetch(entries_.data() + s);
    }

    bool may_be_in(TriangleId t, const std::uint32_t*) const { return first_[slot_of(t)] != none; }
    // Calls visit(s, sample) for those of a triangle, until it returns false; whether it never did.
    template <class Visit>
    bool each_of(TriangleId t, const std::uint32_t*, Visit visit) const {
        for (std::uint32_t s = first_[slot_of(t)]; s != none; s = entries_[s].next)
            if (!visit(s, entries_[s].sample)) return false;
        return true;
    }

    // Calls visit(i, s, sample) for the vertex of a star and the samples in it, with the number of
    // the triangle of the patch in which each would be.
    template <class Number, class Visit>
    bool each_after(const dynamic::Triangulation& mesh, const dynamic::Star& star,
                    std::uint32_t apex, const dynamic::Patch& patch, Number, Visit visit) const {
        const auto pass = [&](std::uint32_t s, const Sample& sample) {
            return visit(find(mesh, patch, sample.point), s, sample);
        };
        if (!pass(apex, at(apex))) return false;
        for (const TriangleId t : star.triangles)
            if (!mesh.slots().is_ghost(t) && !each_of(t, nullptr, pass)) return false;
        return true;
    }

 private:
    struct Entry {
        Sample sample;
        Row row;             // of the caller
        std::uint32_t next;  // in the list of its triangle
    };

    void add(TriangleId t, std::uint32_t s) {
        entries_[s].next = first_[slot_of(t)];
        first_[slot_of(t)] = s;
    }
    bool deal_among_edges(const dynamic::Triangulation& mesh, Interrupt& interrupt);
    // The first triangle of a patch in which a point is.
    std::size_t find(const dynamic::Triangulation& mesh, const dynamic::Patch& patch,
                     Point p) const;
    void find_wedges(const dynamic::Triangulation& mesh);
    std::size_t wedge_of(Point apex, Point p, std::size_t k) const;

    Turns turns_;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> first_;  // of a slot
    std::vector<std::uint32_t> moved_;
    std::vector<std::uint32_t> released_;  // the heads of lists
    std::vector<Point> ends_;              // around the new vertex
    std::vector<TriangleId> wedges_;
};

}  // namespace liftmesh::simplification
