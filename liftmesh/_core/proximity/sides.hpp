// The sides of triangles, numbered: that opposite corner k of triangle t is 3 t + k. Vertices have
// numbers of their own, in the order in which triangles name them, and their positions are copied:
// so neighbours are near each other in memory, whatever the order of the rows, and stay as they are
// if another thread writes to these.
#pragma once

#include "delaunay/triangulated.hpp"
#include "parallel/blocks.hpp"

namespace liftmesh {

using Side = std::uint32_t;
inline constexpr Side no_side = ~Side{0};

class EdgeSides {
 public:
    // One that the interrupt has cut short is of no use.
    EdgeSides(const Triangulated& mesh, Interrupt& interrupt)
        : neighbors_(mesh.neighbors), vertices_(3 * mesh.count) {
        std::vector<std::int32_t> numbers(mesh.points.rows, -1);
        for_each_in_blocks(vertices_.size(), interrupt, [&](std::size_t side) {
            const std::int32_t row = mesh.simplices[side];
            std::int32_t& number = numbers[static_cast<std::size_t>(row)];
            if (number < 0) {
                number = static_cast<std::int32_t>(rows_.size());
                rows_.push_back(row);
                points_.push_back(point(mesh.place(row)));
            }
            vertices_[side] = number;
        });
    }

    std::size_t count() const { return vertices_.size(); }
    std::int32_t opposite(Side side) const { return vertices_[side]; }
    std::int32_t tail(Side side) const { return vertices_[side % 3 == 2 ? side - 2 : side + 1]; }
    std::int32_t head(Side side) const { return vertices_[side % 3 == 0 ? side + 2 : side - 1]; }

    const std::vector<Point>& points() const { return points_; }
    Point place(std::int32_t vertex) const { return points_[static_cast<std::size_t>(vertex)]; }
    std::int32_t row(std::int32_t vertex) const { return rows_[static_cast<std::size_t>(vertex)]; }

    // The same side of the triangle beyond.
    Side across(Side side) const {
        if (neighbors_[side] < 0) return no_side;
        const auto here = static_cast<std::int32_t>(side / 3);
        const Side other = 3 * static_cast<Side>(neighbors_[side]);
        return other + (neighbors_[other + 1] == here) + 2 * (neighbors_[other + 2] == here);
    }
    // Of two triangles the first has the side.
    bool is_first(Side side) const {
        const std::int32_t other = neighbors_[side];
        return other < 0 || static_cast<Side>(other) > side / 3;
    }

 private:
    const std::int32_t* neighbors_;
    std::vector<std::int32_t> vertices_, rows_;
    std::vector<Point> points_;
};

}  // namespace liftmesh
