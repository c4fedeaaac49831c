// A kd tree of cuts learnt from a sample: it sends any point to one of 2^depth cells of about equal
// population. Cuts alternate between the axes and compare both coordinates, so that points with
// equal x are told apart by y, and equal points always share a cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "point.hpp"

namespace liftmesh {

class Cuts {
 public:
    // `sample` is reordered; it needs at least one point for each of the 2^depth cells.
    Cuts(std::vector<Point> sample, int depth);

    int depth() const { return depth_; }
    std::size_t cells() const { return std::size_t{1} << depth_; }

    // The axis across which nodes of a level are cut; level 0 is the root.
    static Axis axis(int level) { return level % 2 == 0 ? Axis::x : Axis::y; }

    std::size_t cell(Point p) const {
        std::size_t node = 1;
        int level = 0;
        for (; level + 1 < depth_; level += 2) {
            node = 2 * node + !before_xy(p, cut_[node]);
            node = 2 * node + !before_yx(p, cut_[node]);
        }
        if (level < depth_) node = 2 * node + !before_xy(p, cut_[node]);
        return node - cells();
    }

 private:
    void learn(std::size_t node, int level, Point* first, Point* last);

    int depth_;
    std::vector<Point> cut_;  // node i has the children 2i and 2i + 1; the root is 1
};

}  // namespace liftmesh
