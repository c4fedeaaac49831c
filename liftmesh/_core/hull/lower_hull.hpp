// From the caller's rows in space to the facets of their lower hull.
#pragma once

#include <cstdint>

#include "base/input.hpp"
#include "base/status.hpp"
#include "delaunay/delaunay.hpp"
#include "paper/counts.hpp"

namespace liftmesh {

enum class HullMethod : std::uint8_t { incremental, lf };

// Rows have three columns, all finite. Of the rows at one planar position only the lowest can be on
// the lower hull: it represents them, the first if several are lowest. `secret` salts the order in
// which `incremental` inserts points, and changes nothing of the result. `counts` is filled by
// `lf`.
Delaunay lower_hull(const Input& input, HullMethod method, std::uint64_t secret, Threads threads,
                    Interrupt& interrupt, paper::Counts& counts);

}  // namespace liftmesh
