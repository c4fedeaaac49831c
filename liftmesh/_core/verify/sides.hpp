// `Member`: which triangulation the triangles should be (lift, constraints); and `Sides`, the exact
// side tests of lifts other than |p|^2.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"
#include "predicates/lift.hpp"
#include "predicates/scale.hpp"

namespace liftmesh {

// Segments that are to be unions of edges.
struct Constraints {
    const std::int32_t* ends = nullptr;  // count x 2: finite rows
    std::size_t count = 0;
    bool are_carved = false;  // regions that they bound may be missing
};

// What the caller says.
struct Member {
    enum class Kind : std::uint8_t { delaunay, weights, radii, metric, farthest, constrained };

    Kind kind = Kind::delaunay;
    const double* values = nullptr;  // one for each row: weights or radii
    ByMetric metric{1, 0, 1};
    Constraints constraints{};

    bool has_values() const { return kind == Kind::weights || kind == Kind::radii; }
    bool is_constrained() const { return kind == Kind::constrained; }
    bool hides_rows() const { return has_values() || kind == Kind::farthest; }
};

class Sides {
 public:
    virtual ~Sides() = default;

    // For rows a, b, c that turn counter-clockwise: +1 where the lift of d is below the plane of
    // their lifts, -1 above, 0 on it.
    virtual int side(Row a, Row b, Row c, Row d) const = 0;
};

// The range of the values, as one of coordinates.
Range range_of_values(const Member& member, const Range& values);

// Scales a value.
double scaled_value(const Member& member, double value, const Scale& scale);

// None for Delaunay triangulations, constrained or not. Points and values are scaled, and stay
// where they are.
std::unique_ptr<Sides> make_sides(const Member& member, const Point* points, const double* values,
                                  Guard guard);

}  // namespace liftmesh
