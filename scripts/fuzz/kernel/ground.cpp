#include "ground.hpp"

#include <bit>

#include "exact.hpp"

namespace fuzzing {

namespace {

// Directions from a point by the angle that a ray turns to them, from just above that of x on.
class Turning {
 public:
    explicit Turning(Point from) : from_(from) {}

    bool is_before(Point p, Point q) const {
        if (part(p) != part(q)) return part(p) < part(q);
        return fuzzing::turn(from_, p, q) > 0;
    }

 private:
    // Above or straight back, below, straight ahead.
    int part(Point p) const {
        if (p.y > from_.y) return 0;
        if (p.y < from_.y) return 1;
        return p.x < from_.x ? 0 : 2;
    }
    Point from_;
};

// The part of the plane around a point on the border of a face that the face takes.
struct Sector {
    Point begin, end;
    std::int32_t face;
};

Sector sector(const Point (&corners)[3], Point query, std::int32_t face) {
    for (int k = 0; k < 3; ++k)
        if (corners[k] == query) return {corners[(k + 1) % 3], corners[(k + 2) % 3], face};
    for (int k = 0; k < 3; ++k) {
        const Point tail = corners[k], head = corners[(k + 1) % 3];
        if (fuzzing::turn(tail, head, query) == 0) return {head, tail, face};
    }
    return {query, query, face};
}

// A number that says nothing of where the point is.
std::uint64_t mark(Point p) {
    const std::uint64_t x = std::bit_cast<std::uint64_t>(p.x),
                        y = std::bit_cast<std::uint64_t>(p.y);
    return (x * 0x9e3779b97f4a7c15 + y) * 0xbf58476d1ce4e5b9;
}

}  // namespace

Ground::Ground(const Scatter& scatter, const liftmesh::Delaunay& found, unsigned leaves_out)
    : at(scatter),
      mesh{scatter.input(), found.result.simplices.get(), found.result.neighbors.get(),
           found.result.triangle_count},
      left_out(mesh.count),
      relief(mesh, {reinterpret_cast<const std::byte*>(scatter.heights.data()), sizeof(double)},
             left_out.data()),
      locator(mesh, 7) {
    for (std::int32_t face = 0; face < count() && leaves_out != 0; ++face) {
        std::uint64_t sum = 0;
        for (int k = 0; k < 3; ++k) sum += mark(mesh.corner(face, k));
        left_out[static_cast<std::size_t>(face)] = (sum >> 20) % leaves_out == 0;
    }
}

Side Ground::side(std::int32_t face, int k) const {
    const std::int32_t beyond = mesh.neighbor(face, k);
    return {mesh.vertex(face, (k + 1) % 3), mesh.vertex(face, (k + 2) % 3),
            relief.is_shown(beyond) ? beyond : -1};
}

std::vector<std::int32_t> Ground::around(Point query) const {
    std::vector<std::int32_t> found;
    for (std::int32_t face = 0; face < count(); ++face) {
        const Point corners[3] = {mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)};
        if (relief.is_shown(face) && contains(corners, query)) found.push_back(face);
    }
    return found;
}

std::int32_t Ground::owner(Point query) const {
    const Turning turning(query);
    Sector first{{}, {}, -1};
    for (const std::int32_t face : around(query)) {
        const Point corners[3] = {mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)};
        const Sector each = sector(corners, query, face);
        if (each.begin == query || turning.is_before(each.end, each.begin)) return face;
        if (first.face < 0 || turning.is_before(each.begin, first.begin)) first = each;
    }
    return first.face;
}

std::size_t Ground::nearest(Point query) const {
    std::size_t least = 0;
    for (std::size_t i = 1; i < at.size(); ++i) {
        const int sign = fuzzing::compare_distances(at.points[i], query, at.points[least], query);
        if (sign < 0 || (sign == 0 && liftmesh::before_xy(at.points[i], at.points[least])))
            least = i;
    }
    return least;
}

}  // namespace fuzzing
