// Preparata and Hong (1977) find the lower hull of two halves and merge them; Dwyer (1987) cuts
// alternately across x and y, which keeps the seams short. The upper cuts are those of the sampled
// kd tree, already made by the ordering; below a cell the points are halved exactly.
//
// Nothing is allocated: the triangle slots of a cell are the scratch space for its selection.

#include "divide_conquer.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

struct Item {
    Point point;
    Row row;
};
static_assert(sizeof(Item) <= sizeof(Triangle), "a cell's slots must hold its points");

class Engine {
 public:
    Engine(Order& order, Triangle* triangles, Interrupt& interrupt)
        : order_(order),
          mesh_(order.points.get(), triangles),
          seam_{mesh_, order.scale.guard, interrupt},
          interrupt_(interrupt) {}

    Status run() {
        node(0, 0);
        return interrupt_.requested() ? Status::interrupted : Status::ok;
    }

 private:
    using Index = std::size_t;

    // The node'th subtree at a level of the kd tree. A subtree with a child too small to stand
    // alone is treated as one cell.
    Part node(int level, Index index) {
        if (interrupted_) return {};
        const Index span = Index{1} << (order_.depth - level);
        const Index first = order_.cell_starts[index * span];
        const Index last = order_.cell_starts[(index + 1) * span];
        if (level == order_.depth) return cell(first, last, Cuts::axis(level));
        const Index middle = order_.cell_starts[index * span + span / 2];
        if (middle - first < 2 || last - middle < 2) return cell(first, last, Cuts::axis(level));
        const Part left = node(level + 1, 2 * index);
        const Part right = node(level + 1, 2 * index + 1);
        return join(left, right, Cuts::axis(level), last - first, middle);
    }

    Part cell(Index first, Index last, Axis axis) {
        Item* items = reinterpret_cast<Item*>(&mesh_[slot(first)]);
        const Index count = last - first;
        for (Index i = 0; i < count; ++i)
            std::construct_at(items + i, Item{order_.points[first + i], order_.rows[first + i]});
        halve(items, count, axis);
        for (Index i = 0; i < count; ++i) {
            order_.points[first + i] = items[i].point;
            order_.rows[first + i] = items[i].row;
        }
        return interrupted_ ? Part{} : build(first, last, axis);
    }

    void halve(Item* items, Index count, Axis axis) {
        constexpr Index worth_asking = Index{1} << 16;
        if (count >= worth_asking) interrupted_ = interrupted_ || interrupt_.requested();
        if (count <= 3 || interrupted_) return;
        Item* middle = items + count / 2;
        const auto select = [&](auto precedes) {
            std::nth_element(items, middle, items + count, [&](const Item& a, const Item& b) {
                return precedes(a.point, b.point);
            });
        };
        axis == Axis::x ? select([](Point p, Point q) { return before_xy(p, q); })
                        : select([](Point p, Point q) { return before_yx(p, q); });
        halve(items, count / 2, other(axis));
        halve(middle, count - count / 2, other(axis));
    }

    Part build(Index first, Index last, Axis axis) {
        const Index count = last - first;
        if (count == 2) return segment(vertex(first), vertex(first + 1), slot(first));
        if (count == 3) return three(vertex(first), slot(first));
        const Index middle = first + count / 2;
        const Part left = build(first, middle, other(axis));
        const Part right = build(middle, last, other(axis));
        return join(left, right, axis, count, middle);
    }

    Part join(Part left, Part right, Axis axis, Index count, Index middle) {
        constexpr Index worth_asking = 4096;
        if (interrupted_ || (count >= worth_asking && interrupt_.requested())) {
            interrupted_ = true;
            return left;
        }
        return merge(seam_, left, right, axis, slot(middle) - 2);
    }

    Part segment(Vertex p, Vertex q, TriangleId there) {
        const TriangleId back = there + 1;
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
        const TriangleId pq = at + 1, qr = at + 2, rp = at + 3;
        mesh_[at].vertex[0] = p;
        mesh_[at].vertex[1] = q;
        mesh_[at].vertex[2] = r;
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

    // Three points on a line: a hull of two sides, with a ghost on either side of each edge.
    Part chain_of_three(Vertex p, Vertex q, Vertex r, TriangleId at) {
        Vertex line[3] = {p, q, r};
        std::sort(line, line + 3,
                  [&](Vertex v, Vertex w) { return before_xy(mesh_.point(v), mesh_.point(w)); });
        const TriangleId pq = at, qr = at + 1, rq = at + 2, qp = at + 3;
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
    static TriangleId slot(Index position) { return static_cast<TriangleId>(2 * position); }

    Order& order_;
    Mesh mesh_;
    Seam seam_;
    Interrupt& interrupt_;
    bool interrupted_ = false;
};

}  // namespace

Status divide_and_conquer(Order& order, Triangle* triangles, Interrupt& interrupt) {
    return Engine(order, triangles, interrupt).run();
}

}  // namespace liftmesh
