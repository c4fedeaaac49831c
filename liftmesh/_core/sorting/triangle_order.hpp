// The canonical order of triangles: each begins with its least corner, by x, then y, and they
// follow each other by their first corner, then by the second one. It depends on the triangles as
// sets of points alone, and those that are near each other in the plane are near in memory, too.
#pragma once

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// By x, then y; or along a Hilbert curve first.
enum class RowOrder : std::uint8_t { canonical, curve };

// Where each row comes among those that triangles have; -1 for others. False if the interrupt came
// first.
bool rank_rows(const Input& points, const std::int32_t* simplices, std::size_t count,
               std::vector<std::int32_t>& ranks, Interrupt& interrupt,
               RowOrder order = RowOrder::canonical);

// Triangles, and for each side the triangle beyond; of each, flags of its sides in the lowest three
// bits, and others above; null if there are none.
struct Triangles {
    const std::int32_t *simplices, *neighbors;
    const std::uint8_t* bits;
    std::size_t count;
};

struct OrderedTriangles {
    Buffer<std::int32_t> simplices, neighbors, names;  // the last: the new number of each
    Buffer<std::uint8_t> bits;
};

// With `ranks` of the rows, below `most`; null if the rows are in order. False as above.
bool order_triangles(const Triangles& given, const std::int32_t* ranks, std::size_t most,
                     OrderedTriangles& ordered, ThreadPool& pool);

}  // namespace liftmesh
