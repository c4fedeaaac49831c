// Alpha complexes of Delaunay triangulations in the plane and in space (H. Edelsbrunner and
// E. P. Muecke, "Three-dimensional alpha shapes", ACM TOG 13, 1994).
//
// A simplex enters with the radius of its smallest sphere, or circle, if no point is strictly
// inside of that; otherwise with the first simplex that it is a side of. For a Delaunay
// triangulation it suffices to ask for the points that share a larger simplex with it: if one
// inside is beyond these, it is also inside the sphere of a Delaunay simplex. Radii are rounded up,
// so those of the complex for a double alpha are exactly those that are at most alpha.
//
// All arrays are of triangulations without flaws: positive simplices, and neighbours across the
// facet opposite each vertex, -1 outside. Points of the plane have z = 0.
#pragma once

#include "base/buffer.hpp"
#include "base/status.hpp"
#include "predicates/circumradius.hpp"

namespace liftmesh {

template <int K>
struct SimplexView {
    const SpacePoint* points;
    const std::int32_t *simplices, *neighbors;  // count x K
    std::size_t count;
};

// Faces of one dimension, each with ascending corners, and the radii with which they enter.
template <int K>
struct AlphaFaces {
    std::vector<std::array<std::int32_t, K>> corners;
    std::vector<double> radii;
};

// Of `count` simplices, in their order.
template <int K>
bool circumradii(const SpacePoint* points, const std::int32_t* simplices, std::size_t count,
                 RadiusRounding rounding, Interrupt& interrupt, double* radii);

template <int K>
struct AlphaFiltration {
    AlphaFaces<K - 1> facets;
    AlphaFaces<2> edges;  // of tetrahedra; those of triangles are the facets
};

// From the radii of all simplices to those of their facets, and of these to the edges. Faces are in
// the order of the first simplex that has them. False if the interrupt came first.
template <int K>
bool find_alpha_filtration(const SimplexView<K>& view, const double* radii, Interrupt& interrupt,
                           AlphaFiltration<K>& found);

// The shape: which simplices belong to it, the facets between them and the outside, which turn
// counter-clockwise seen from outside (edges have the shape on their left), and facets that belong
// to the complex, but to no simplex of it.
template <int K>
struct AlphaSurface {
    std::vector<std::array<std::int32_t, K - 1>> facets, singular;
};

template <int K>
bool find_alpha_surface(const SimplexView<K>& view, double alpha, Interrupt& interrupt,
                        std::uint8_t* is_inside, AlphaSurface<K>& surface);

// The least alpha for which every vertex is a corner of a simplex of the complex and these form at
// most so many components, connected across facets. NaN if the interrupt came first.
double solid_alpha(const std::int32_t* simplices, const std::int32_t* neighbors, std::size_t count,
                   std::size_t corners, std::size_t rows, const double* radii,
                   std::size_t components, Interrupt& interrupt);

}  // namespace liftmesh
