// A surface over a finished triangulation: a height for each row, and faces that are left out.
//
// A point of the closed faces that are left has one *owner* among them: the face that contains what
// is infinitesimally to the right of the point, and above it by infinitesimally less. On a border,
// where there is none or it is left out, the owner is the next face counter-clockwise around the
// point. It depends on coordinates alone.
#pragma once

#include "base/buffer.hpp"
#include "delaunay/first_containing.hpp"
#include "delaunay/made_on_demand.hpp"
#include "delaunay/triangulated.hpp"
#include "surface/facet.hpp"
#include "surface/first_faces.hpp"
#include "surface/nearest.hpp"

namespace liftmesh {

// One height a row, at any stride.
struct Heights {
    const std::byte* data;
    std::ptrdiff_t stride;

    double operator[](std::int32_t row) const {
        return *reinterpret_cast<const double*>(data + row * stride) + 0.0;
    }
    [[gnu::always_inline]] void prefetch(std::int32_t row) const {
        liftmesh::prefetch(data + row * stride);
    }
};

inline constexpr double no_height = std::numeric_limits<double>::quiet_NaN();

class Relief {
 public:
    // `left_out` has a flag for each simplex; null if no face is left out.
    Relief(const Triangulated& mesh, Heights heights, const std::uint8_t* left_out)
        : mesh_(mesh),
          heights_(heights),
          shown_{left_out},
          first_faces_(mesh.count),
          nearest_tree_(price_of_tree * mesh.count) {}

    const Triangulated& mesh() const { return mesh_; }
    bool is_shown(std::int32_t simplex) const { return shown_.has(simplex); }
    // At a place that is no vertex: a side is shown if a face at it is.
    bool is_shown(std::int32_t simplex, Place place) const {
        return is_shown(simplex) ||
               (place.kind == Place::side && is_shown(mesh_.neighbor(simplex, place.k)));
    }
    SurfaceCorner corner(std::int32_t simplex, int k) const {
        const std::int32_t row = mesh_.vertex(simplex, k);
        return {point(mesh_.place(row)), heights_[row]};
    }
    double height_of(std::int32_t row) const { return heights_[row]; }

    // Fetches a face's corners, whose rows may be anywhere in memory.
    [[gnu::always_inline]] void prefetch(std::int32_t simplex) const {
        for (int k = 0; k < 3; ++k) {
            const std::int32_t row = mesh_.vertex(simplex, k);
            mesh_.points.prefetch(static_cast<std::size_t>(row));
            heights_.prefetch(row);
        }
    }
    SurfaceFacet facet(std::int32_t simplex) const {
        return {corner(simplex, 0), corner(simplex, 1), corner(simplex, 2)};
    }

    // At a point of a closed triangle, shown or not; NaN if no face that is left contains it.
    double height(Point query, std::int32_t simplex, Patience& patience) const;

    // The owner of such a point; -1 if there is none. -2 if the interrupt came first.
    std::int32_t owner(Point query, std::int32_t simplex, Patience& patience) const;

    // Whether a face owns the points on its side opposite corner k, the ends apart.
    bool owns_side(std::int32_t simplex, int k) const;

    // The owner of the position of a vertex, by a triangle at it.
    std::int32_t owner_of_vertex(std::int32_t row, std::int32_t simplex, Patience& patience) const;

    // The vertex nearest to a point of a closed triangle, or, if that is negative, anywhere;
    // `unfinished` if the interrupt came first.
    std::int32_t nearest(Point query, std::int32_t simplex, Patience& patience) const;

    using Place = liftmesh::Place;
    Place place(Point query, std::int32_t simplex) const { return place_in(mesh_, simplex, query); }

    // With the place known; at a vertex, the triangle must be shown.
    double height(Point query, std::int32_t simplex, Place place) const;

    // With the place known, whatever triangle it is.
    double height(Point query, std::int32_t simplex, Place place, Patience& patience) const;

 private:
    static constexpr std::size_t price_of_tree = 4;  // steps for each triangle

    Triangulated mesh_;
    Heights heights_;
    Shown shown_;
    mutable MadeOnDemand<FirstFaces> first_faces_;
    mutable MadeOnDemand<NearestTree> nearest_tree_;  // paid for by steps of long walks
};

}  // namespace liftmesh
