// Heights and gradients of a surface at many points: each is located and then judged while its
// triangle is still in the cache.
#pragma once

#include "delaunay/locate.hpp"
#include "parallel/thread_pool.hpp"
#include "surface/natural.hpp"
#include "surface/relief.hpp"
#include "surface/span.hpp"

namespace liftmesh {

// NaN where no face contains the point. False if the interrupt came first.
bool sample_heights(const Relief& relief, Locator& locator, const Queries& queries, double* heights,
                    Threads threads, Interrupt& interrupt);

// The same from natural neighbours, which the triangulation has to be Delaunay for.
bool sample_natural(const Relief& relief, Locator& locator, const Queries& queries, Natural method,
                    double* heights, Threads threads, Interrupt& interrupt);

// What a height, or another value, is made of at each point: z = za + sum of w (z - za) over the
// rows after the first, a, and not beyond any of them. The bits are those of `sample_heights`, or
// `sample_natural`.
struct PointWeights {
    std::vector<std::int64_t> starts;  // one more than points
    std::vector<std::int32_t> rows;    // from the lexicographically least on, counter-clockwise
    std::vector<double> weights;       // those of a point add up to 1
    bool is_sound = true;              // rows that were written meanwhile have not been noticed
};

bool sample_weights(const Relief& relief, Locator& locator, const Queries& queries, Natural method,
                    PointWeights& found, Threads threads, Interrupt& interrupt);

// Of the face that owns the point: dz/dx and dz/dy.
bool sample_gradients(const Relief& relief, Locator& locator, const Queries& queries,
                      double* gradients, Threads threads, Interrupt& interrupt);

// The simplex that owns the point; -1 if no face contains it.
bool sample_owners(const Relief& relief, Locator& locator, const Queries& queries,
                   std::int32_t* owners, Threads threads, Interrupt& interrupt);

// From triangles to pixels: each row of each face is a span of columns, and pixels on borders go to
// the face that owns their centre. The values are those that `sample` gives at the centres.
//
// The rows are divided into bands, each with a list of the faces that reach it; threads take bands.
// Faces that are many times longer than what they cover, as those of a fan, would be met in every
// row: where that takes longer, the centres are located like other points.

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

// The least and the greatest height of the faces that are left.

struct HeightRange {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
};

// NaN if a height is not finite; from infinity to -infinity if there is no face. False if the
// interrupt came first.
bool height_range(const Relief& relief, HeightRange& found, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
