#include "paper/points.hpp"

#include "predicates/determinants.hpp"
#include "predicates/distances.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::paper {

namespace {

constexpr double unit_roundoff = 0x1p-53;

Extent measure(const std::vector<SpacePoint>& p) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    SpacePoint low{inf, inf, inf}, high{-inf, -inf, -inf};
    for (const SpacePoint& point : p) {
        low = {std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z)};
        high = {std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z)};
    }
    const auto greatest = [](double l, double h) { return std::max(std::fabs(l), std::fabs(h)); };
    const auto spread = [](double l, double h) { return (h - l) * (1 + 4 * unit_roundoff); };
    return {
        {greatest(low.x, high.x), greatest(low.y, high.y), greatest(low.z, high.z)},
        {spread(low.x, high.x), spread(low.y, high.y), spread(low.z, high.z)},
    };
}

std::vector<SpacePoint> lift(std::span<const Point> planar, Point q) {
    std::vector<SpacePoint> p(planar.size());
    std::transform(planar.begin(), planar.end(), p.begin(), [q](Point t) {
        const double dx = t.x - q.x, dy = t.y - q.y;
        return SpacePoint{t.x, t.y, dx * dx + dy * dy};
    });
    return p;
}

}  // namespace

Points::Points(std::vector<SpacePoint> p, Guard guard)
    : p_(std::move(p)), extent_(measure(p_)), guard_(guard) {}

// Two differences, each squared, and a sum: z is off by less than 4.01 unit_roundoff z, or by an
// underflow.
LiftedPoints::LiftedPoints(std::span<const Point> planar, Point q, Guard guard)
    : Points(lift(planar, q), guard), q_(q) {
    error_of_z_ = 5 * unit_roundoff * extent_.greatest.z + 0x1p-1000;
}

int LiftedPoints::compare_z(Vertex a, Vertex b) const {
    const double difference = p_[a].z - p_[b].z;
    const double error = 3 * error_of_z();
    if (std::fabs(difference) > error) return difference > 0 ? 1 : -1;
    return compare_distances(planar(a), q_, planar(b), q_);
}

// The differences are off by unit_roundoff, those of z by 2 error_of_z() in addition; heights that
// overflow make the comparison fail.
int LiftedPoints::turn_in_oyz(Vertex a, Vertex b, Vertex c) const {
    const double by = p_[b].y - p_[a].y, bz = p_[b].z - p_[a].z;
    const double cy = p_[c].y - p_[a].y, cz = p_[c].z - p_[a].z;
    const double det = by * cz - cy * bz;
    const double error = (std::fabs(by) + std::fabs(cy)) *
                             (3 * error_of_z() + 8 * unit_roundoff * extent_.greatest.z) +
                         guard().margin() + 1e-300;
    if (std::fabs(det) > error) return det > 0 ? 1 : -1;
    return liftmesh::turn_in_oyz(planar(a), planar(b), planar(c), q_);
}

int SpacePoints::compare_z(Vertex a, Vertex b) const {
    return (p_[a].z > p_[b].z) - (p_[a].z < p_[b].z);
}

int SpacePoints::turn_in_oyz(Vertex a, Vertex b, Vertex c) const {
    const auto projected = [&](Vertex v) { return Point{p_[v].y, p_[v].z}; };
    return orient2d(projected(a), projected(b), projected(c));
}

}  // namespace liftmesh::paper
