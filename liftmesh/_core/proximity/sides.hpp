// The sides of triangles, numbered: that opposite corner k of triangle t is 3 t + k.
#pragma once

#include "delaunay/triangulated.hpp"

namespace liftmesh {

using Side = std::uint32_t;
inline constexpr Side no_side = ~Side{0};

class Sides {
 public:
    explicit Sides(const Triangulated& mesh) : mesh_(mesh) {}

    std::size_t count() const { return 3 * mesh_.count; }
    std::int32_t opposite(Side side) const { return mesh_.simplices[side]; }
    std::int32_t tail(Side side) const { return mesh_.simplices[side + (side % 3 == 2 ? -2 : 1)]; }
    std::int32_t head(Side side) const { return mesh_.simplices[side + (side % 3 == 0 ? 2 : -1)]; }
    Point place(std::int32_t row) const { return point(mesh_.place(row)); }

    // The same side of the triangle beyond.
    Side across(Side side) const {
        const std::int32_t other = mesh_.neighbors[side];
        if (other < 0) return no_side;
        const int k = mesh_.place_of_neighbor(other, static_cast<std::int32_t>(side / 3));
        return 3 * static_cast<Side>(other) + static_cast<Side>(k);
    }
    // Of two triangles the first has the side.
    bool is_first(Side side) const {
        const std::int32_t other = mesh_.neighbors[side];
        return other < 0 || static_cast<Side>(other) > side / 3;
    }

 private:
    const Triangulated& mesh_;
};

}  // namespace liftmesh
