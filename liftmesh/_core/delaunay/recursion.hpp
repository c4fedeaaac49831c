// Which parts divide and conquer makes and joins, in what order, and on which thread.
//
// The upper cuts are those of the sampled kd tree, already made by the ordering; below a cell the
// points are halved where they lie, down to leaves of two, three or four. The box of a part comes
// from its leaves, as the bounds of filters grow with the box. The thread pool runs the subtrees,
// and then the joins above them, level by level. A subtree owns its points and its triangle slots,
// so nothing needs a lock, and no output depends on which thread writes it.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/mesh.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/seen_from_base.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

// How a part will be merged: across which axis, and whether as the second one.
struct Meeting {
    Axis axis;
    bool as_second;
};

// The last point across the axis in a first part, the first one in a second.
template <unsigned count>
unsigned meeting_point(const Site* sites, Meeting meeting) {
    const auto along = static_cast<unsigned>(meeting.axis);
    unsigned best = 0;
    for (unsigned i = 1; i < count; ++i) {
        const Pair p = pair(sites[best].point), q = pair(sites[i].point);
        const bool follows =
            (p[along] < q[along]) | ((p[along] == q[along]) & (p[1 - along] < q[1 - along]));
        best = follows != meeting.as_second ? i : best;
    }
    return best;
}

// The box of a few sites.
inline Bounds bounds_of(const Site* sites, std::size_t count) {
    Bounds box(pair(sites[0].point));
    for (std::size_t i = 1; i < count; ++i) box.add(pair(sites[i].point));
    return box;
}

// `Engine` derives from this and provides
//
//     void prefetch(first, count)                        what leaves will read of a cell's sites
//     Certainty certainty(box)                           for what happens within it
//     Boxed leaf(first, count, meeting)                  of at most four points
//     Part merged(certainty, left, right, axis, slot)    where `slot` is the first of its two
template <class Engine, class Part, class Box>
class Recursion {
 protected:
    using Index = std::size_t;
    static constexpr Index most_in_a_leaf = 4;

    // A part and the box of its points.
    struct Boxed {
        Part part{};
        Box box{};
    };

    Recursion(Order& order, Site* sites, ThreadPool& pool)
        : order_(order), pool_(pool), interrupt_(pool.interrupt()), sites_(sites) {}

    Part whole() {
        if (pool_.size() == 1) return node(1).part;
        const int shared = static_cast<int>(std::bit_width(8 * pool_.size()));
        parts_.resize(std::size_t{2} << shared);
        joins_.resize(static_cast<std::size_t>(shared));
        share_out(1, shared);
        pool_.run(subtrees_.size(), [&](Index i) { parts_[subtrees_[i]] = node(subtrees_[i]); });
        for (; !joins_.empty(); joins_.pop_back()) {
            const std::vector<Index>& level = joins_.back();
            pool_.run(level.size(), [&](Index i) { parts_[level[i]] = join_children(level[i]); });
        }
        return parts_[1].part;
    }

    Boxed halved(Index first, Index count) {
        const MedianSplit half = median_split(&sites_[first], count);
        const Index rest = count - half.middle, middle = first + half.middle;
        const Boxed left = build(first, half.middle, {half.axis, false});
        const Boxed right = build(middle, rest, {half.axis, true});
        return join(left, right, half.axis, count, middle);
    }

    static Vertex vertex(Index position) { return static_cast<Vertex>(position); }
    static TriangleId slot(Index position) { return triangle_in(2 * position); }

    Order& order_;
    ThreadPool& pool_;
    Interrupt& interrupt_;
    Site* sites_;

 private:
    Engine& engine() { return static_cast<Engine&>(*this); }

    // Nodes of the kd tree are numbered as in a heap: the root is 1, the children of h are 2 h and
    // 2 h + 1.
    static int level_of(Index h) { return static_cast<int>(std::bit_width(h)) - 1; }

    // The points of a node, and where its cut divides them.
    struct Extent {
        Index first, middle, last;
    };
    Extent extent(Index h) const {
        const Index span = Index{1} << (order_.splitters.depth() - level_of(h));
        const Index* start = &order_.cell_starts[(h - (Index{1} << level_of(h))) * span];
        return {start[0], start[span / 2], start[span]};
    }
    // A node with a child of fewer than two points is treated as one cell.
    bool is_cell(Index h) const {
        if (level_of(h) == order_.splitters.depth()) return true;
        const Extent at = extent(h);
        return at.middle - at.first < 2 || at.last - at.middle < 2;
    }

    void share_out(Index h, int levels) {
        if (levels == 0 || is_cell(h)) {
            subtrees_.push_back(h);
            return;
        }
        share_out(2 * h, levels - 1);
        share_out(2 * h + 1, levels - 1);
        joins_[static_cast<Index>(level_of(h))].push_back(h);
    }

    Meeting meeting_of(Index h) const {
        return {h == 1 ? Axis::x : order_.splitters.axis(h / 2), h % 2 == 1};
    }

    Boxed node(Index h) {
        const Extent at = extent(h);
        if (is_to_end(at.last - at.first)) return {};
        if (is_cell(h)) return cell(h, at);
        const Boxed left = node(2 * h);
        const Boxed right = node(2 * h + 1);
        return join_node(h, left, right);
    }

    Boxed join_children(Index h) { return join_node(h, parts_[2 * h], parts_[2 * h + 1]); }

    Boxed join_node(Index h, const Boxed& left, const Boxed& right) {
        const Extent at = extent(h);
        return join(left, right, order_.splitters.axis(h), at.last - at.first, at.middle);
    }

    Boxed cell(Index h, Extent at) {
        const Index count = at.last - at.first;
        interrupt_.advance(work::triangulating * count);
        engine().prefetch(at.first, count);
        return build(at.first, count, meeting_of(h));
    }

    Boxed build(Index first, Index count, Meeting meeting) {
        if (count <= most_in_a_leaf) return engine().leaf(first, count, meeting);
        if (is_to_end(count)) return {};
        return halved(first, count);
    }

    // Only large parts poll the interrupt, so only they are ever left unfinished. An interrupt is
    // permanent and the parent of an unfinished part is larger, so no join touches such a part.
    bool is_to_end(Index count) {
        constexpr Index worth_asking = 4096;
        return count >= worth_asking && interrupt_.requested();
    }

    Boxed join(const Boxed& left, const Boxed& right, Axis axis, Index count, Index middle) {
        if (is_to_end(count)) return {};
        Box box = left.box;
        box.add(right.box);
        const Certainty certainty = engine().certainty(box);
        return {engine().merged(certainty, left.part, right.part, axis, slot(middle - 1)), box};
    }

    std::vector<Index> subtrees_;            // nodes that are one task each
    std::vector<std::vector<Index>> joins_;  // the nodes above them, by level
    std::vector<Boxed> parts_;               // of both, by node
};

}  // namespace liftmesh
