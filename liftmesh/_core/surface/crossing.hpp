// Where a level crosses a side: on the side from its lexicographically lesser end.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "surface/facet.hpp"

namespace liftmesh {

namespace detail {

inline double on_the_way(double from, double to, double share) {
    const double at = from + share * (to - from);
    const double kept = std::isfinite(at) ? at : (from / 2 + share * (to / 2 - from / 2)) * 2;
    return std::min(std::max(kept, std::min(from, to)), std::max(from, to));
}

}  // namespace detail

// One end is below the level, the other is not. An end at the level is the point itself.
inline Point crossing(SurfaceCorner u, SurfaceCorner v, double level) {
    if (before_xy(v.at, u.at)) std::swap(u, v);
    if (u.height == level) return u.at;
    if (v.height == level) return v.at;
    double share = (level - u.height) / (v.height - u.height);
    if (!std::isfinite(v.height - u.height))
        share = (level / 2 - u.height / 2) / (v.height / 2 - u.height / 2);
    return {detail::on_the_way(u.at.x, v.at.x, share), detail::on_the_way(u.at.y, v.at.y, share)};
}

}  // namespace liftmesh
