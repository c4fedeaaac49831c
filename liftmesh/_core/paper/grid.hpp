// A grid of equal cells, about one point to each: the spatial index of the restricted region.
//
// Cells are numbered row by row, and points are stored cell by cell, so the points of a box are one
// run of memory for each row of cells that it meets.
#pragma once

#include "base/point.hpp"

namespace liftmesh::paper {

struct Box {
    double min_x, max_x, min_y, max_y;
};

// Equal cells along one axis. `cell` is monotonic in its argument, so the cells from cell(low) to
// cell(high) hold every point between low and high, however the arithmetic rounds.
class Cells {
 public:
    Cells() = default;
    Cells(double low, double high, std::size_t count)
        : low_(low), last_(static_cast<double>(count - 1)) {
        const double width = (high - low) / static_cast<double>(count);
        per_unit_ = width > 0 && std::isfinite(1 / width) ? 1 / width : 0;
        width_ = per_unit_ > 0 ? width : high - low;
    }

    std::size_t count() const { return static_cast<std::size_t>(last_) + 1; }
    std::size_t cell(double value) const {
        const double at = (value - low_) * per_unit_;
        return at > 0 ? static_cast<std::size_t>(std::min(at, last_)) : 0;
    }
    double width() const { return width_; }
    double low() const { return low_; }

 private:
    double low_ = 0, last_ = 0, per_unit_ = 0, width_ = 0;
};

class Grid {
 public:
    // Sorts the sites by cell.
    explicit Grid(std::span<Site> sites);

    const Cells& columns() const { return columns_; }
    const Cells& lines() const { return lines_; }
    const Box& bounds() const { return bounds_; }

    // The points in the cells of one line, from one column to another: [first, last).
    struct Run {
        Vertex first, last;
    };
    Run run(std::size_t line, std::size_t from, std::size_t to) const {
        const std::uint32_t* starts = &starts_[line * columns_.count()];
        return {starts[from], starts[to + 1]};
    }

 private:
    std::size_t cell(Point p) const {
        return lines_.cell(p.y) * columns_.count() + columns_.cell(p.x);
    }

    Box bounds_;
    Cells columns_, lines_;
    std::vector<std::uint32_t> starts_;
};

}  // namespace liftmesh::paper
