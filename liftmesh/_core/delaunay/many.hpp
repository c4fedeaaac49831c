// Many sets of points, each triangulated by itself, on any thread: what each set gives alone, one
// after the other.
#pragma once

#include "delaunay/delaunay.hpp"

namespace liftmesh {

// The results of consecutive sets. All numbers of rows count from the first row of their set.
struct Sets {
    // Where the set ends in each of the lists below.
    struct End {
        std::size_t triangles, hull, duplicates, skipped;
    };

    Status status = Status::ok;  // or non_finite
    std::size_t row = 0;         // of all, the first that is not finite
    std::vector<End> ends;       // of a set that has no triangle: no further ones, and no hull
    std::vector<std::int32_t> simplices, neighbors, hull;
    std::vector<Duplicate> duplicates;
    std::vector<Row> skipped;
};

// Set i consists of the rows from starts[i] to starts[i + 1]. The parts of the result are those of
// blocks of sets, in order. False if interrupted.
bool delaunay_many(const Input& input, std::span<const std::int64_t> starts, bool skip_non_finite,
                   Threads threads, Interrupt& interrupt, std::vector<Sets>& parts);

}  // namespace liftmesh
