// A surface with vertices along a Hilbert curve, and triangles by their first ones on it:
// neighbours in the plane are near in memory. All are copies, which nobody else changes.
#pragma once

#include "sorting/triangle_order.hpp"
#include "surface/face_pair.hpp"

namespace liftmesh {

class LocalSurface {
 public:
    // False if the interrupt came first.
    bool read(const Relief& relief, Interrupt& interrupt);

    std::size_t count() const { return shown_.size(); }
    std::size_t vertices() const { return corners_.size(); }
    double largest() const { return largest_; }  // coordinate, in magnitude
    // An order of surfaces: whether it has fewer vertices or, at the first that differ, the lesser.
    bool is_before(const LocalSurface& other) const;
    // The new number of a simplex of the relief.
    std::int32_t named(std::int32_t simplex) const { return triangles_.names[simplex]; }

    Face face(std::int32_t face) const;
    std::int32_t vertex(std::int32_t face, std::size_t k) const {
        return triangles_.simplices[3 * static_cast<std::size_t>(face) + k];
    }
    std::int32_t neighbor(std::int32_t face, std::size_t side) const {
        return triangles_.neighbors[3 * static_cast<std::size_t>(face) + side];
    }
    // Beyond a side, if that is shown; -1 if not.
    std::int32_t shown_neighbor(std::int32_t face, std::size_t side) const {
        const std::int32_t beyond = neighbor(face, side);
        return beyond >= 0 && is_shown(beyond) ? beyond : -1;
    }
    bool is_shown(std::int32_t face) const { return shown_[static_cast<std::size_t>(face)] == 1; }
    // Leaves out those that are flat within some units, beside those that never are shown.
    void hide_flat(Nearness nearness);
    const SurfaceCorner& corner(std::int32_t vertex) const {
        return corners_[static_cast<std::size_t>(vertex)];
    }

 private:
    OrderedTriangles triangles_;
    std::vector<SurfaceCorner> corners_;
    std::vector<std::uint8_t> shown_;  // 2: not now
    double largest_ = 0;
};

}  // namespace liftmesh
