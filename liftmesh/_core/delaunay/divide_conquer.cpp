// Preparata and Hong (1977) find the lower hull of two halves and merge them; Dwyer (1987) cuts
// across both axes, which keeps the seams short; here each cut goes across the axis along which its
// points spread more (recursion.hpp).

#include "delaunay/divide_conquer.hpp"

#include "base/pair.hpp"
#include "delaunay/leaves.hpp"

namespace liftmesh {

namespace {

// The parts of a triangulation by a lift that hides no site.
template <class Lift>
class Engine : Leaves<Engine<Lift>, Part, Bounds> {
    using Base = Leaves<Engine<Lift>, Part, Bounds>;
    using typename Base::Common;
    using typename Base::Index;

 public:
    Engine(const Lift& lift, Guard guard, Order& order, ThreadPool& pool, Construction& result)
        : Base(order, pool, result), lift_(lift), seam_{this->mesh_, guard, this->interrupt_} {}

    // Returns a ghost of the whole triangulation.
    TriangleId run() { return this->whole().lower; }

 private:
    friend Base;
    friend Common;

    void prefetch(Index, Index) const {}
    static Bounds box_of(const Site* sites, Index count) { return bounds_of(sites, count); }

    Certainty certainty(const Bounds& box) const {
        return certainty_within(lift_, box.low, box.high, seam_.guard);
    }

    unsigned signs_of_four(const Site* sites, const Certainty& certainty) const {
        return liftmesh::signs_of_four(lift_, sites, certainty, seam_.guard);
    }

    Part chain(const Site* sites, Index first, Meeting meeting) {
        return this->place(chain_leaves[middle_of_three(sites)], sites, first, meeting);
    }

    Part merged(const Certainty& certainty, Part left, Part right, Axis axis, TriangleId slot) {
        return merge(lift_, seam_, certainty, left, right, axis, slot);
    }

    [[no_unique_address]] Lift lift_;
    Seam seam_;
};

}  // namespace

void make_room(Order& order, Construction& result) {
    result.count = order.count;
    result.points = allocate<Point>(order.count);
    result.rows = allocate<Row>(order.count);
    static_assert(sizeof(Site) == sizeof(Vertex[2 * words_per_triangle]));
    result.vertices = reuse<Vertex>(std::move(order.sites));
    result.twins = allocate<Edge>(words_per_triangle * (2 * order.count - 2));
}

template <class Lift>
Status divide_and_conquer(const Lift& lift, Guard guard, Order& order, ThreadPool& pool,
                          Construction& result) {
    make_room(order, result);
    result.some_ghost = Engine<Lift>(lift, guard, order, pool, result).run();
    return pool.interrupt().requested() ? Status::interrupted : Status::ok;
}

template Status divide_and_conquer(const Paraboloid&, Guard, Order&, ThreadPool&, Construction&);
template Status divide_and_conquer(const Farthest&, Guard, Order&, ThreadPool&, Construction&);
template Status divide_and_conquer(const ByMetric&, Guard, Order&, ThreadPool&, Construction&);

}  // namespace liftmesh
