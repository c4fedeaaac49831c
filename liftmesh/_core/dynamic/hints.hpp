// Vertices near to any place, at which walks begin that have no better hint.
//
// Each cell of a grid has the vertex that came last. With about four vertices in a cell few steps
// lead to a place. Where vertices crowd in a cell, its own may be far from most: then there is no
// hint. It costs as much as many walks to make a grid, and so it takes many to have one.
#pragma once

#include "base/pair.hpp"

namespace liftmesh::dynamic {

class Hints {
 public:
    // A walk begins. Whether cells are to be made: for so many vertices there are none, or few.
    bool are_due(std::size_t vertices) {
        return ++walks_ > vertices / 2048 + 16 && vertices > 2 * vertices_ && vertices <= most;
    }

    void make(std::size_t vertices, const Bounds& box) {
        const auto side = std::sqrt(static_cast<double>(vertices) / 4) + 1;
        const auto cells = static_cast<std::size_t>(side);
        cells_.assign(cells * cells, Cell());
        side_ = cells;
        // Halves, so that no difference overflows.
        low_ = {box.low[0] / 2, box.low[1] / 2};
        const double width = box.high[0] / 2 - low_.x, height = box.high[1] / 2 - low_.y;
        size_ = {width > 0 ? width : 1, height > 0 ? height : 1};
        vertices_ = vertices;
        walks_ = 0;
    }

    void note(Point p, Vertex v) {
        if (cells_.empty()) return;
        Cell& cell = cells_[place(p)];
        cell.vertex = v;
        ++cell.count;
    }

    // A vertex in the cell of a place, or the ghost; points[v] is where it is now.
    Vertex near(Point p, const std::vector<Point>& points) const {
        if (cells_.empty()) return ghost;
        const Cell& cell = cells_[place(p)];
        const bool is_use = cell.vertex != ghost && cell.count <= crowd;
        return is_use && place(points[cell.vertex]) == place(p) ? cell.vertex : ghost;
    }

 private:
    static constexpr std::size_t most = 1 << 24;  // vertices: making cells is not interrupted
    static constexpr std::uint32_t crowd = 32;

    struct Cell {
        Vertex vertex = ghost;
        std::uint32_t count = 0;
    };

    std::size_t place(Point p) const {
        return part((p.y / 2 - low_.y) / size_.y) * side_ + part((p.x / 2 - low_.x) / size_.x);
    }
    std::size_t part(double share) const {
        const auto last = static_cast<double>(side_ - 1);
        return share > 0 ? static_cast<std::size_t>(std::fmin(share, 1) * last) : 0;
    }

    std::vector<Cell> cells_;
    std::size_t side_ = 0;
    Point low_{}, size_{};
    std::size_t vertices_ = 0, walks_ = 0;
};

}  // namespace liftmesh::dynamic
