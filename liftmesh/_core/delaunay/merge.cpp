#include "delaunay/merge.hpp"

namespace liftmesh {

namespace {

// All sites stay vertices. Since this type belongs to this file alone, so do the merges with it:
// only then a compiler inlines all of a merge, and keeps its state in registers.
struct NothingHides {
    static void save(const Mesh&, TriangleId) {}
    static void open(Side) {}
    static void advance(Side) {}
    static bool is_covered(Side, bool) { return false; }
};

}  // namespace

template <class Lift>
Part merge(const Lift& lift, const Seam& seam, const Certainty& certainty, Part first, Part second,
           Axis axis, TriangleId slot) {
    NothingHides nothing_hides;
    OnePassMerge<Lift, NothingHides> merge(lift, seam, nullptr, certainty, slot, nothing_hides);
    merge.run(first, second, axis);
    return merge.part(axis);
}

template Part merge(const Paraboloid&, const Seam&, const Certainty&, Part, Part, Axis, TriangleId);
template Part merge(const Farthest&, const Seam&, const Certainty&, Part, Part, Axis, TriangleId);
template Part merge(const ByMetric&, const Seam&, const Certainty&, Part, Part, Axis, TriangleId);

}  // namespace liftmesh
