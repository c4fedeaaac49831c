// Vertices, regions and clipped cells, for a sanitizer to watch.
#pragma once

#include "clouds.hpp"
#include "delaunay/delaunay.hpp"

namespace parallel {

// Ends the process if threads change the vertices. Cells are clipped with the rows that were
// triangulated, with others, and interrupted.
void check_cells(const Cloud& cloud, const liftmesh::Delaunay& found);

}  // namespace parallel
