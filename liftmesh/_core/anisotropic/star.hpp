// The star of a point p in its own metric: the triangles around p in the Delaunay triangulation of
// all points in that metric.
//
// Seen from p, sort points by angle. One of them, between two others less than a half turn apart,
// is no neighbour of p if it is outside the ellipse through p and these two. Where no such test
// removes another point, all of them are neighbours in the triangulation of these points alone:
// inversion about p maps ellipses through p to lines, and neighbours to corners of a convex polygon
// around p. So
// 1. start with the Euclidean neighbours of p, and remove;
// 2. search all points for one inside the ellipse of a triangle of the star, insert it by its
//    angle, and remove beside it, until every ellipse is empty.
// The convex hull is the same in every metric: on it, a star begins and ends with its neighbours on
// the hull, which are never removed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "anisotropic/ellipse.hpp"
#include "base/point.hpp"
#include "predicates/lift.hpp"
#include "sorting/kd_tree.hpp"

namespace liftmesh::anisotropic {

// The points as given, and the same times a power of two, at most 1, for filters. Where that would
// round they are all zero: then no filter decides anything.
struct Points {
    std::span<const Point> given;
    std::vector<Point> scaled;
};
Points scaled(std::span<const Point> given);

class Star {
 public:
    Star(const Points& points, const KdTree& tree) : points_(points), tree_(tree) {}

    // Of a row, from its Euclidean neighbours: on the hull from the next corner to the one before.
    // Otherwise in any order.
    void build(Row p, const Metric& metric, std::span<const Row> neighbors, bool is_on_hull);

    // The neighbours, counter-clockwise: on the hull from the next corner on, otherwise from the
    // lowest row on.
    void write(std::vector<std::int32_t>& out) const;

 private:
    struct Search;
    using Place = std::uint32_t;  // in the list of neighbours
    static constexpr Place none = ~Place{0};
    struct Neighbor {
        Row row;
        Place before, after;
        bool is_gone;
    };

    void start(std::span<const Row> neighbors);
    void settle();
    bool is_removable(Place at) const;
    void remove(Place at);
    std::optional<Row> intruder(Place at) const;
    void insert(Row t, Place beside);

    bool is_left(Row a, Row b) const;  // whether b is less than a half turn after a
    bool is_upper(Row a) const;
    bool precedes(Row a, Row b) const;
    bool is_inside(const Ellipse& ellipse, Row a, Row b, Row t) const;
    bool is_inside_exactly(Row a, Row b, Row t) const;
    Point relative(Row row) const;
    Ellipse ellipse(Row a, Row b) const;

    const Points& points_;
    const KdTree& tree_;
    Row p_ = 0;
    ByMetric given_metric_{};
    Metric metric_{};  // scaled
    bool is_on_hull_ = false;
    std::vector<Neighbor> list_;
    std::vector<Place> pending_;    // neighbours whose triangle with the next is to be searched
    std::vector<Place> unsettled_;  // neighbours that may be removable
};

}  // namespace liftmesh::anisotropic
