// A kd tree of cuts learnt from a sample: it sends any point to one of 2^depth cells of about equal
// population. Cuts alternate between the axes and compare both coordinates, so that points with
// equal x are told apart by y, and equal points always share a cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "point.hpp"
#include "team.hpp"

namespace liftmesh {

class Cuts {
 public:
    // `sample` is reordered; it needs at least one point for each of the 2^depth cells.
    Cuts(std::vector<Point> sample, int depth);
    Cuts(std::vector<Point> sample, int depth, Team& team);

    int depth() const { return depth_; }
    std::size_t cells() const { return std::size_t{1} << depth_; }

    // The axis across which nodes of a level are cut; level 0 is the root.
    static Axis axis(int level) { return level % 2 == 0 ? Axis::x : Axis::y; }

    std::size_t cell(Point p) const { return cells(std::array{p})[0]; }

    // Several points go down the tree abreast: none waits for another.
    template <std::size_t N>
    std::array<std::uint32_t, N> cells(const std::array<Point, N>& points) const {
        std::array<std::uint32_t, N> node;
        node.fill(1);
        const auto descend = [&](auto precedes) {
            for (std::size_t i = 0; i < N; ++i)
                node[i] = 2 * node[i] + !precedes(points[i], cut_[node[i]]);
        };
        int level = 0;
        for (; level + 1 < depth_; level += 2) {
            descend(before_xy);
            descend(before_yx);
        }
        if (level < depth_) descend(before_xy);
        for (std::uint32_t& n : node) n -= static_cast<std::uint32_t>(cells());
        return node;
    }

 private:
    // Finds the cut of a node among its part of the sample, and puts it in the middle of that part.
    Point* cut(std::size_t node, int level, Point* first, Point* last);
    void learn(std::size_t node, int level, Point* first, Point* last);

    int depth_;
    std::vector<Point> cut_;  // node i has the children 2i and 2i + 1; the root is 1
};

}  // namespace liftmesh
