#include "surface/first_faces.hpp"

#include "delaunay/first_containing.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

int corner_at(const Triangulated& mesh, std::int32_t simplex, std::int32_t row) {
    return mesh.vertex(simplex, 0) == row ? 0 : mesh.vertex(simplex, 1) == row ? 1 : 2;
}

// Directions from a vertex by their angle, from 0 on.
bool is_in_upper_half(Point vertex, Point p) {  // above 0, up to a half turn
    return p.y > vertex.y || (p.y == vertex.y && p.x < vertex.x);
}

// The corner of a face at a vertex: the angle between two sides.
struct Angle {
    Point vertex, first, second;

    Angle(const Triangulated& mesh, std::int32_t simplex, int k)
        : vertex(mesh.corner(simplex, k)),
          first(mesh.corner(simplex, (k + 1) % 3)),
          second(mesh.corner(simplex, (k + 2) % 3)) {}

    // Whether it has what is just above the direction of x.
    bool is_ahead() const {
        return !is_in_upper_half(vertex, first) && is_in_upper_half(vertex, second);
    }
    bool is_before(const Angle& other) const {
        if (is_ahead() || other.is_ahead()) return is_ahead();
        const bool upper = is_in_upper_half(vertex, first);
        if (upper != is_in_upper_half(vertex, other.first)) return upper;
        return orient2d(vertex, first, other.first) > 0;
    }
};

}  // namespace

std::int32_t first_face_around(const Triangulated& mesh, Shown shown, std::int32_t row,
                               std::int32_t simplex, std::size_t& steps) {
    std::int32_t best = outside;
    const auto look_at = [&](std::int32_t face) {
        if (!shown.has(face)) return;
        const Angle angle(mesh, face, corner_at(mesh, face, row));
        if (best < 0 || angle.is_before(Angle(mesh, best, corner_at(mesh, best, row)))) best = face;
    };
    look_at(simplex);
    for (const int turn : {1, 2}) {
        std::int32_t at = simplex;
        for (;; --steps) {
            if (steps == 0) return unfinished;
            at = mesh.neighbor(at, (corner_at(mesh, at, row) + turn) % 3);
            if (at == simplex) return best;
            if (at < 0) break;
            look_at(at);
        }
    }
    return best;
}

FirstFaces::FirstFaces(const Triangulated& mesh, Shown shown, Patience& patience)
    : first_(mesh.points.rows, outside) {
    const auto count = static_cast<std::int32_t>(mesh.count);
    for (std::int32_t face = 0; face < count && !patience.ends(); ++face) {
        if (!shown.has(face)) continue;
        for (int k = 0; k < 3; ++k) {
            std::int32_t& first = first_[static_cast<std::size_t>(mesh.vertex(face, k))];
            if (first < 0 ||
                Angle(mesh, face, k)
                    .is_before(Angle(mesh, first, corner_at(mesh, first, mesh.vertex(face, k)))))
                first = face;
        }
    }
}

}  // namespace liftmesh
