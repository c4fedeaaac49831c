// Surfaces over triangulated points, for a sanitizer to watch.
#pragma once

#include <cstddef>

#include "clouds.hpp"
#include "delaunay/delaunay.hpp"

namespace parallel {

// Exits with a message if threads change a height, a pixel, a line or a ring; runs are interrupted,
// too.
void check_surfaces(const Cloud& cloud, const liftmesh::Delaunay& found);

// The same calls while their rows and heights are written. Whatever comes out, it comes.
void check_spoilt_surfaces(std::size_t rows, unsigned most_threads);

}  // namespace parallel
