// The recursion is Delaunay's. A leaf of three or four sites may hide one; a leaf of four takes a
// row of Delaunay's table if all four are vertices, and is halved otherwise.

#include "base/buffer.hpp"
#include "base/pair.hpp"
#include "delaunay/divide_conquer.hpp"
#include "delaunay/leaves.hpp"
#include "delaunay/regular_merge.hpp"

namespace liftmesh {

namespace {

// The box of sites, and the range of their values.
struct LiftedBounds {
    Bounds box{};
    double least = 0, greatest = 0;

    void add(double value) {
        least = std::min(least, value);
        greatest = std::max(greatest, value);
    }
    void add(const LiftedBounds& other) {
        box.add(other.box);
        add(other.least);
        add(other.greatest);
    }
};

template <class Lift>
class RegularEngine : Leaves<RegularEngine<Lift>, RegularPart, LiftedBounds> {
    using Base = Leaves<RegularEngine<Lift>, RegularPart, LiftedBounds>;
    using typename Base::Common;
    using typename Base::Index;

 public:
    RegularEngine(const Lift& lift, const double* value_of_row, Order& order, ThreadPool& pool,
                  Construction& result, double* values)
        : Base(order, pool, result),
          value_of_row_(value_of_row),
          values_(values),
          lifted_{this->mesh_, values_, lift, order.scale.guard} {}

    RegularPart run() { return this->whole(); }

 private:
    friend Base;
    friend Common;

    // Values of rows that are anywhere in memory arrive in parallel.
    [[gnu::always_inline]] void prefetch(Index first, Index count) const {
        for (const Site* site = &this->sites_[first]; count > 0; --count, ++site)
            liftmesh::prefetch(&value_of_row_[site->row]);
    }

    LiftedBounds box_of(const Site* sites, Index count) const {
        const double value = value_of_row_[sites[0].row];
        LiftedBounds bounds{bounds_of(sites, count), value, value};
        for (Index i = 1; i < count; ++i) bounds.add(value_of_row_[sites[i].row]);
        return bounds;
    }

    Certainty certainty(const LiftedBounds& bounds) const {
        return certainty_within<Lift>(bounds.box.low, bounds.box.high, bounds.least,
                                      bounds.greatest, lifted_.guard);
    }

    // If the middle one is hidden it comes last, and two slots remain.
    RegularPart chain(Site* sites, Index first, Meeting meeting) {
        const unsigned middle = middle_of_three(sites);
        const unsigned before = (middle + 1) % 3, after = (middle + 2) % 3;
        if (!is_hidden_between(lifted_.lift, site(sites[before]), site(sites[middle]),
                               site(sites[after])))
            return this->place(chain_leaves[middle], sites, first, meeting);
        std::swap(sites[middle], sites[2]);
        store(sites[2], first + 2);
        RegularPart part = this->place(segment_leaf, sites, first, meeting);
        const TriangleId spare = this->slot(first) + 2 * words_per_triangle;
        bury(this->mesh_, spare, spare + words_per_triangle);
        bury(this->mesh_, spare + words_per_triangle, FreeList::none);
        part.free = {spare, spare + words_per_triangle, 2};
        return part;
    }

    void store(const Site& site, Index position) {
        Base::store(site, position);
        values_[position] = value_of_row_[site.row];
    }

    Lifted<Lift> site(const Site& s) const { return {s.point, value_of_row_[s.row]}; }

    // `no_leaf` also where one of the four is hidden.
    unsigned signs_of_four(const Site* s, const Certainty& certainty) const {
        const unsigned turns = turns_of_four(s);
        if (turns == no_leaf) return no_leaf;
        const unsigned signs = turns | static_cast<unsigned>(is_last_below(s, certainty)) << 4;
        return quadrilateral_leaves[signs].is_complete() ? signs : no_leaf;
    }

    bool is_last_below(const Site* s, const Certainty& certainty) const {
        const auto value = [&](int k) { return value_of_row_[s[k].row]; };
        const auto at = [&](int k) { return pair(s[k].point); };
        const LiftedBase<Lift> base(at(0), value(0), at(1), value(1));
        const double below = base.below(base.place(at(2), value(2)), base.place(at(3), value(3)));
        if (std::fabs(below) > certainty.of_circle) return below > 0;
        return lifted_side_canonical_exact(lifted_.lift, site(s[0]), site(s[1]), site(s[2]),
                                           site(s[3]), lifted_.guard) > 0;
    }

    RegularPart merged(const Certainty& certainty, const RegularPart& first,
                       const RegularPart& second, Axis axis, TriangleId slot) {
        return regular_merge(lifted_, certainty, this->interrupt_, first, second, axis, slot);
    }

    const double* value_of_row_;
    double* values_;
    LiftedMesh<Lift> lifted_;
};

}  // namespace

template <class Lift>
Status divide_and_conquer(const Lift& lift, const typename Lift::Value* value_of_row, Order& order,
                          ThreadPool& pool, Construction& result) {
    make_room(order, result);
    const Buffer<double> values = allocate<double>(order.count);
    const RegularPart whole =
        RegularEngine<Lift>(lift, value_of_row, order, pool, result, values.get()).run();
    result.some_ghost = whole.lower;
    result.dead = whole.free.count;
    return pool.interrupt().requested() ? Status::interrupted : Status::ok;
}

template Status divide_and_conquer(const ByWeight&, const double*, Order&, ThreadPool&,
                                   Construction&);
template Status divide_and_conquer(const ByRadius&, const double*, Order&, ThreadPool&,
                                   Construction&);

}  // namespace liftmesh
