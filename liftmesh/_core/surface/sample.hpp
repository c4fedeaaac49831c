// Heights and gradients of a surface at many points: each is located and then judged while its
// triangle is still in the cache.
#pragma once

#include "delaunay/locate.hpp"
#include "surface/natural.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

// NaN where no face contains the point. False if the interrupt came first.
bool sample_heights(const Relief& relief, Locator& locator, const Queries& queries, double* heights,
                    Threads threads, Interrupt& interrupt);

// The same from natural neighbours, which the triangulation has to be Delaunay for.
bool sample_natural(const Relief& relief, Locator& locator, const Queries& queries, Natural method,
                    double* heights, Threads threads, Interrupt& interrupt);

// Of the face that owns the point: dz/dx and dz/dy.
bool sample_gradients(const Relief& relief, Locator& locator, const Queries& queries,
                      double* gradients, Threads threads, Interrupt& interrupt);

// The simplex that owns the point; -1 if no face contains it.
bool sample_owners(const Relief& relief, Locator& locator, const Queries& queries,
                   std::int32_t* owners, Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
