// From triangles to pixels: each row of each face is a span of columns, and pixels on borders go to
// the face that owns their centre. The values are those that `sample` gives at the centres.
//
// The rows are divided into bands, each with a list of the faces that reach it; threads take bands.
// Faces that are many times longer than what they cover, as those of a fan, would be met in every
// row: where that takes longer, the centres are located like other points.
#pragma once

#include "delaunay/locate.hpp"
#include "surface/grid.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

// Each fills one value per pixel, row by row; NaN, or -1, where no face contains the centre. False
// if the interrupt came first.
bool scan_heights(const Relief& relief, Locator& locator, const Grid& grid, double* heights,
                  Threads threads, Interrupt& interrupt);
bool scan_heights(const Relief& relief, Locator& locator, const Grid& grid, float* heights,
                  Threads threads, Interrupt& interrupt);
// dz/dx and dz/dy of the face that owns the centre.
bool scan_gradients(const Relief& relief, Locator& locator, const Grid& grid, double* gradients,
                    Threads threads, Interrupt& interrupt);
// The simplex that owns the centre.
bool scan_owners(const Relief& relief, Locator& locator, const Grid& grid, std::int32_t* owners,
                 Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
