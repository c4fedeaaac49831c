// The points of a surface, each of which is a vertex of its approximation or a sample that the
// approximation must not miss. Those of a triangle are a list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/point.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::simplification {

inline constexpr std::uint32_t none = ~std::uint32_t{0};

struct Sample {
    Point point;
    double height;
    Row row;             // of the caller
    std::uint32_t next;  // in the list of its triangle
};

// What to approximate: distinct points with their heights, and those on their hull,
// counter-clockwise.
struct Terrain {
    const Point* points;
    const double* heights;
    std::size_t count;
    const std::int32_t* hull;
    std::size_t hull_count;
};

// In the order of a Hilbert curve and, within its cells, of their coordinates.
std::vector<Sample> samples_of(const Terrain& terrain);

// The corners of the hull, from the lexicographically least one, without points between two.
std::vector<Row> corners_of(const Terrain& terrain);

// Signs of turns. Where all coordinates are multiples of one power of two, and their range is below
// 2^26 of it, as in rasters, the determinant of doubles is exact.
class Turns {
 public:
    explicit Turns(const Terrain& terrain);
    int operator()(Point a, Point b, Point c) const {
        if (!is_exact_) return orient2d(a, b, c);
        const double det = (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
        return (det > 0) - (det < 0);
    }

 private:
    bool is_exact_ = false;
};

}  // namespace liftmesh::simplification
