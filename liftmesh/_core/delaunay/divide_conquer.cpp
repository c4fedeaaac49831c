// Preparata and Hong (1977) find the lower hull of two halves and merge them; Dwyer (1987) cuts
// across both axes, which keeps the seams short; here each cut goes across the axis along which its
// points spread more. The upper cuts are those of the sampled kd tree, already made by the
// ordering; below a cell the points are halved where they lie, down to two or three, which move to
// their final places.
//
// The thread pool runs the subtrees, and then the joins above them, level by level. A subtree owns
// its points and its triangle slots, so nothing needs a lock, and no output depends on which thread
// writes it.

#include "delaunay/divide_conquer.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "predicates/orient2d.hpp"
#include "sorting/cuts.hpp"
#include "sorting/halving.hpp"

namespace liftmesh {

namespace {

class Engine {
 public:
    Engine(Order& order, ThreadPool& pool, Construction& result)
        : order_(order),
          pool_(pool),
          interrupt_(pool.interrupt()),
          sites_(reinterpret_cast<Site*>(result.vertices.get())),
          points_(result.points.get()),
          rows_(result.rows.get()),
          mesh_(points_, result.vertices.get(), result.twins.get()),
          seam_{mesh_, order.scale.guard, interrupt_} {}

    // Returns a ghost of the whole triangulation.
    TriangleId run() {
        const int shared =
            pool_.size() == 1 ? 0 : static_cast<int>(std::bit_width(8 * pool_.size()));
        parts_.resize(std::size_t{2} << shared);
        joins_.resize(static_cast<std::size_t>(shared));
        share_out(1, shared);
        pool_.run(subtrees_.size(), [&](Index i) { parts_[subtrees_[i]] = node(subtrees_[i]); });
        for (; !joins_.empty(); joins_.pop_back()) {
            const std::vector<Index>& level = joins_.back();
            pool_.run(level.size(), [&](Index i) { parts_[level[i]] = join_children(level[i]); });
        }
        return parts_[1].lower;
    }

 private:
    using Index = std::size_t;
    static constexpr Index most_in_a_leaf = 3;

    // Nodes of the kd tree are numbered as in a heap: the root is 1, the children of h are 2 h and
    // 2 h + 1.
    static int level_of(Index h) { return static_cast<int>(std::bit_width(h)) - 1; }

    // The points of a node, and where its cut divides them.
    struct Extent {
        Index first, middle, last;
    };
    Extent extent(Index h) const {
        const Index span = Index{1} << (order_.cuts.depth() - level_of(h));
        const Index* start = &order_.cell_starts[(h - (Index{1} << level_of(h))) * span];
        return {start[0], start[span / 2], start[span]};
    }
    // A node with a child of fewer than two points is treated as one cell.
    bool is_cell(Index h) const {
        if (level_of(h) == order_.cuts.depth()) return true;
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

    Part node(Index h) {
        const Extent at = extent(h);
        if (is_to_end(at.last - at.first)) return {};
        if (is_cell(h)) return cell(at);
        const Part left = node(2 * h);
        const Part right = node(2 * h + 1);
        return join_node(h, left, right);
    }

    Part join_children(Index h) { return join_node(h, parts_[2 * h], parts_[2 * h + 1]); }

    Part join_node(Index h, Part left, Part right) {
        const Extent at = extent(h);
        return join(left, right, order_.cuts.axis(h), at.last - at.first, at.middle);
    }

    Part cell(Extent at) {
        const Index count = at.last - at.first;
        interrupt_.advance(work::triangulating * count);
        return build(at.first, count);
    }

    Part build(Index first, Index count) {
        if (count <= most_in_a_leaf) return leaf(first, count);
        if (is_to_end(count)) return {};
        const Halving half = halve(&sites_[first], count);
        const Index rest = count - half.middle, middle = first + half.middle;
        const Part left = build(first, half.middle);
        const Part right = build(middle, rest);
        return join(left, right, half.axis, count, middle);
    }

    // The triangles are written where the sites were. `memcpy` reads these before: to a compiler,
    // objects of other types are never in the same place.
    Part leaf(Index first, Index count) {
        Site sites[most_in_a_leaf];
        std::memcpy(sites, &sites_[first], count * sizeof(Site));
        for (Index i = 0; i < count; ++i) {
            points_[first + i] = sites[i].point;
            rows_[first + i] = sites[i].row;
        }
        return count == 2 ? segment(vertex(first), vertex(first + 1), slot(first))
                          : three(vertex(first), slot(first));
    }

    // Only large parts poll the interrupt, so only they are ever left unfinished. An interrupt is
    // permanent and the parent of an unfinished part is larger, so no join touches such a part.
    bool is_to_end(Index count) {
        constexpr Index worth_asking = 4096;
        return count >= worth_asking && interrupt_.requested();
    }

    Part join(Part left, Part right, Axis axis, Index count, Index middle) {
        if (is_to_end(count)) return {};
        return merge(seam_, left, right, axis, slot(middle - 1));
    }

    Part segment(Vertex p, Vertex q, TriangleId there) {
        const TriangleId back = there + words_per_triangle;
        mesh_.place_ghost(there, p, q);
        mesh_.place_ghost(back, q, p);
        mesh_.join(mesh_.hull_edge(there), mesh_.hull_edge(back));
        mesh_.chain(there, back);
        mesh_.chain(back, there);
        return {there, there};
    }

    Part three(Vertex first, TriangleId at) {
        Vertex p = first, q = first + 1, r = first + 2;
        const int turn = orient2d(mesh_.point(p), mesh_.point(q), mesh_.point(r));
        if (turn == 0) return chain_of_three(p, q, r, at);
        if (turn < 0) std::swap(q, r);
        const TriangleId pq = at + words_per_triangle, qr = pq + words_per_triangle,
                         rp = qr + words_per_triangle;
        mesh_.vertex(at, 0) = p;
        mesh_.vertex(at, 1) = q;
        mesh_.vertex(at, 2) = r;
        mesh_.place_ghost(pq, p, q);
        mesh_.place_ghost(qr, q, r);
        mesh_.place_ghost(rp, r, p);
        mesh_.join(edge(at, 2), mesh_.hull_edge(pq));
        mesh_.join(edge(at, 0), mesh_.hull_edge(qr));
        mesh_.join(edge(at, 1), mesh_.hull_edge(rp));
        mesh_.chain(pq, qr);
        mesh_.chain(qr, rp);
        mesh_.chain(rp, pq);
        return {pq, pq};
    }

    // Three collinear points: a hull of two edges, with a ghost on either side of each.
    Part chain_of_three(Vertex p, Vertex q, Vertex r, TriangleId at) {
        Vertex line[3] = {p, q, r};
        std::sort(line, line + 3,
                  [&](Vertex v, Vertex w) { return before_xy(mesh_.point(v), mesh_.point(w)); });
        const TriangleId pq = at, qr = pq + words_per_triangle, rq = qr + words_per_triangle,
                         qp = rq + words_per_triangle;
        mesh_.place_ghost(pq, line[0], line[1]);
        mesh_.place_ghost(qr, line[1], line[2]);
        mesh_.place_ghost(rq, line[2], line[1]);
        mesh_.place_ghost(qp, line[1], line[0]);
        mesh_.join(mesh_.hull_edge(pq), mesh_.hull_edge(qp));
        mesh_.join(mesh_.hull_edge(qr), mesh_.hull_edge(rq));
        mesh_.chain(pq, qr);
        mesh_.chain(qr, rq);
        mesh_.chain(rq, qp);
        mesh_.chain(qp, pq);
        return {pq, pq};
    }

    static Vertex vertex(Index position) { return static_cast<Vertex>(position); }
    static TriangleId slot(Index position) { return triangle_in(2 * position); }

    Order& order_;
    ThreadPool& pool_;
    Interrupt& interrupt_;
    Site* sites_;  // in the memory of the vertices
    Point* points_;
    Row* rows_;
    Mesh mesh_;
    Seam seam_;
    std::vector<Index> subtrees_;            // nodes that are one task each
    std::vector<std::vector<Index>> joins_;  // the nodes above them, by level
    std::vector<Part> parts_;                // of both, by node
};

}  // namespace

Status divide_and_conquer(Order& order, ThreadPool& pool, Construction& result) {
    result.count = order.count;
    result.points = allocate<Point>(order.count);
    result.rows = allocate<Row>(order.count);
    static_assert(sizeof(Site) == sizeof(Vertex[2 * words_per_triangle]));
    result.vertex_room = 2 * words_per_triangle * order.room;
    result.vertices = reuse<Vertex>(std::move(order.sites));
    result.twins = allocate<Edge>(words_per_triangle * (2 * order.count - 2));
    result.some_ghost = Engine(order, pool, result).run();
    return pool.interrupt().requested() ? Status::interrupted : Status::ok;
}

}  // namespace liftmesh
