// The points of a surface, each of which is a vertex of its approximation or a sample that the
// approximation must not miss. Those of a grid are found by scanning a triangle (grid.hpp); others
// are in lists, one for each triangle (lists.hpp).
#pragma once

#include "base/point.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/sample.hpp"

namespace liftmesh::simplification {

inline constexpr std::uint32_t none = ~std::uint32_t{0};

struct Sample {
    Point point;
    double height;
};

// What to approximate: distinct points with their heights, those on their hull, counter-clockwise,
// and edges, which meet each other and points at their ends only.
struct Terrain {
    const Point* points;
    const double* heights;
    std::size_t count;
    const std::int32_t* hull;
    std::size_t hull_count;
    const std::int32_t* edges = nullptr;  // two ends each
    std::size_t edge_count = 0;
};

// The corners of the hull, from the lexicographically least one, without points between two.
std::vector<Row> corners_of(const Terrain& terrain);

// What every approximation has: the corners, then the other ends of edges in the order of their
// coordinates; and edges, between places among these, in an order that is random, lest each crosses
// what those before have left behind (constrained/constrained.cpp), and the same for any of the
// caller's.
struct Skeleton {
    std::vector<Row> rows;
    std::vector<std::pair<std::size_t, std::size_t>> edges;
};
Skeleton skeleton_of(const Terrain& terrain);

// A random order of points. Where many cost the same, as on level ground, they do not go in the
// order of their coordinates: the triangles behind the last one would become ever longer, and each
// step would look at the samples of a whole row.
inline bool is_drawn_before(Point p, Point q) {
    const std::uint64_t of_p = random_number(hash(p), 0), of_q = random_number(hash(q), 0);
    return of_p != of_q ? of_p < of_q : before_xy(p, q);
}

// Numbers as multiples of a power of two.
class Steps {
 public:
    void add(double value);
    void add_size(double value);
    // Sizes, and differences of any two numbers, are less than 2 to this power, in such steps.
    int bits() const;

 private:
    void refine(double value);

    int exponent_ = std::numeric_limits<int>::max();
    double low_ = std::numeric_limits<double>::infinity(), high_ = -low_, size_ = 0;
};

// Signs of turns. Where coordinates are so few steps apart, as in rasters, the determinant of
// doubles is exact.
class Turns {
 public:
    explicit Turns(const Terrain& terrain);
    Turns(const std::vector<double>& xs, const std::vector<double>& ys);
    int bits() const { return bits_; }
    int operator()(Point a, Point b, Point c) const {
        if (bits_ > most_bits) return orient2d(a, b, c);
        const double det = (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
        return (det > 0) - (det < 0);
    }

 private:
    static constexpr int most_bits = 26;
    int bits_;
};

// What no distance should exceed.
struct Tolerance {
    Tolerance(const Terrain& terrain, const Turns& turns, double tolerance);
    double value;
    bool is_exact;  // doubles suffice to compare distances with it
};

}  // namespace liftmesh::simplification
