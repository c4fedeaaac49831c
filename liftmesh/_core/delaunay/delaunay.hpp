// The entry points of the room: Delaunay, regular and farthest-point triangulations, from the
// caller's rows to the output arrays.
#pragma once

#include "base/facets.hpp"
#include "base/input.hpp"
#include "base/status.hpp"
#include "delaunay/mesh.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/lift.hpp"
#include "sorting/spatial_sort.hpp"

namespace liftmesh {

// Fewer than 2 n triangles take three names of edges each, which stay within the numbers of the
// result.
inline constexpr std::size_t most_rows = 0x7fffffff / (2 * words_per_triangle);

struct Delaunay {
    Status status = Status::ok;
    std::size_t row = 0;       // the first non-finite row, where that is the status
    std::size_t distinct = 0;  // how many positions there are
    std::vector<Duplicate> duplicates;
    std::vector<Row> skipped;
    Result result;
};

// Of lifts that hide rows.
struct Regular : Delaunay {
    std::vector<Row> hidden;  // ascending: strictly above the lower hull
};

// The first stage of every engine: sorts the distinct points, and fills in the outcome as far as
// it is known. The engine continues if the status is ok.
Delaunay start(const Input& input, bool skip_non_finite, ThreadPool& pool, Order& order,
               const Range& other = {});

// The same for engines that need only one thread afterwards.
Delaunay start(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt,
               Order& order);

// By divide and conquer.
Delaunay delaunay(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt);

// The same in a metric.
Delaunay delaunay(const ByMetric& by, const Input& input, bool skip_non_finite, Threads threads,
                  Interrupt& interrupt);

// Regular triangulations of weighted points, from the caller's rows to the result.

// One number for each row: contiguous or not, float64 or float32, finite; radii not negative.
struct Values {
    const std::byte* data;
    std::ptrdiff_t stride;  // in bytes
    bool single_precision;
    bool are_radii;  // otherwise weights

    double operator[](std::size_t row) const {
        const std::byte* at = data + static_cast<std::ptrdiff_t>(row) * stride;
        return single_precision ? static_cast<double>(*reinterpret_cast<const float*>(at))
                                : *reinterpret_cast<const double*>(at);
    }
};

// `duplicates` names the rows at the position of another of the same value; lighter ones at the
// position of a heavier are `hidden`.
Regular regular(const Input& input, const Values& values, bool skip_non_finite, Threads threads,
                Interrupt& interrupt);

// Farthest-point Delaunay triangulations: every point lies in the circle of every triangle.

// The vertices are the corners of the convex hull. `duplicates` names further rows at these,
// `hidden` all other rows but the skipped ones. `distinct` is counted where there are no three
// corners, and is 0 elsewhere.
Regular farthest(const Input& input, bool skip_non_finite, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
