// Points in space along a Hilbert curve: neighbours in space are neighbours in memory.
#pragma once

#include "base/input.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/insphere.hpp"
#include "predicates/scale.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

// The caller's rows, copied once: finite where they are not skipped.
struct SpaceRows {
    Buffer<SpacePoint> points;  // of each row
    std::size_t count = 0;
    std::vector<Row> skipped;  // ascending
};

// False if the interrupt came first.
bool read_space(const Input& input, Interrupt& interrupt, SpaceRows& rows);

// What is known of all points at once, once a power of two has moved them into the window.
class SpaceScale {
 public:
    void add(const SpacePoint& p);
    void settle();

    SpacePoint operator()(const SpacePoint& p) const;
    bool moves() const { return scale_.moves; }
    const Trust& trust() const { return trust_; }

 private:
    Range range_;
    int lowest_bit_ = std::numeric_limits<int>::max();
    Scale scale_{Range{}};
    Trust trust_;
};

// The distinct points, in the order of the curve, equal places by x, y, z: it is the same however
// the rows are ordered.
struct SpaceOrder {
    Buffer<SpacePoint> points;
    Buffer<Row> rows;
    std::size_t count = 0;
    std::vector<Duplicate> duplicates;  // by ascending row
    Trust trust;
};

// Takes the rows. False if the interrupt came first.
bool sort_in_space(SpaceRows rows, ThreadPool& pool, SpaceOrder& order);

}  // namespace liftmesh
