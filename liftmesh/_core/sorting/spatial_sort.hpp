// The points in kd order: neighbours in the plane are neighbours in memory.
#pragma once

#include "base/buffer.hpp"
#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/scale.hpp"
#include "sorting/splitters.hpp"

namespace liftmesh {

// Of the rows at one position the lowest is kept.
struct Duplicate {
    Row row, kept;
};

// The distinct points, by the cells of a sampled kd tree. Inside a cell they keep the order of
// their rows; the engine refines a cell when it reaches it.
struct Order {
    Buffer<Site> sites;
    std::size_t count = 0;
    Splitters splitters = Splitters({}, 0);
    std::vector<std::size_t> cell_starts;  // and the end of the last
    std::vector<Duplicate> duplicates;     // by ascending row
    std::vector<Row> skipped;              // non-finite rows, ascending
    Scale scale{Range{}};                  // from the caller's rows to the points
};

struct OrderResult {
    Status status;
    std::size_t row;  // of the first non-finite point, where that is the status
};

// Fills `order`. A row that another thread writes meanwhile counts as it was when it was copied:
// the sites are those of points that nobody else changes. `skip_non_finite` leaves non-finite rows
// out instead of reporting the first. The scale has room for magnitudes in `other` as well.
OrderResult spatial_sort(const Input& input, bool skip_non_finite, ThreadPool& pool, Order& order,
                         const Range& other = {});

// Sorts the sites by row instead: the cells have no meaning from then on.
void sort_by_row(Order& order);

// Exact duplicates: of the rows at one position the lowest is kept.

// Moves the first of each position to the front, in order, and returns how many there are. The
// others come after them, in any order, and are appended to `duplicates`. Rows must ascend among
// equal points, as they do when sites come in the order of their rows.
std::size_t deduplicate(Site* sites, std::size_t count, std::vector<Duplicate>& duplicates);

// Unites the duplicates among so many rows, by ascending row. False if the interrupt came first.
bool unite(const std::vector<std::vector<Duplicate>>& found, std::size_t rows, ThreadPool& pool,
           std::vector<Duplicate>& sorted);

// Cuts inside a cell: a few points are halved by their ranks; more points are partitioned near
// their middle, in one branch-free pass, by a pivot chosen from nine of them. Points that share a
// coordinate stay together where enough is left on the other side.

struct MedianSplit {
    Axis axis;
    std::size_t middle;
};

// Reorders `count` >= 4 sites of distinct positions: every site before the middle precedes across
// the axis every site from it on. At least two stand on each side. The axis is the one along which
// they spread more, estimated from nine of them.
MedianSplit median_split(Site* sites, std::size_t count);

}  // namespace liftmesh
