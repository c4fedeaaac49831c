// A kd tree of cuts, built from a sample: it maps any point to one of 2^depth cells of about equal
// population. A cut goes across the axis along which its part of the sample spreads more, and
// compares one coordinate: points with equal x are on one side of it. Where so many share it that
// little is left on the other side, the cut goes across the other axis, so a column is cut by y.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

// Indexed by axis, so that comparing across either axis takes no branch.
using Coordinates = std::array<double, 2>;
template <std::size_t N>
using Abreast = std::array<Coordinates, N>;

// A half-open rectangle, of finite points only.
class Cell {
 public:
    void cut(Axis axis, double value, bool keep_upper) {
        const auto along = static_cast<std::size_t>(axis);
        if (keep_upper) {
            from_[along] = std::max(from_[along], value);
        } else {
            to_[along] = std::min(to_[along], value);
        }
    }
    bool contains(const Bounds& box) const {
        const PairBits inside = (box.low >= from_) & (box.high < to_);
        return (inside[0] & inside[1]) != 0;
    }

 private:
    static constexpr double infinity = std::numeric_limits<double>::infinity(),
                            lowest = std::numeric_limits<double>::lowest();
    Pair from_{lowest, lowest}, to_{infinity, infinity};
};

class Splitters {
 public:
    // `sample` is reordered; it needs at least one point for each of the 2^depth cells.
    Splitters(std::vector<Point> sample, int depth);
    Splitters(std::vector<Point> sample, int depth, ThreadPool& pool);

    int depth() const { return depth_; }
    std::size_t cells() const { return std::size_t{1} << depth_; }

    // The axis across which a node is cut: the root is 1, node i has the children 2 i and 2 i + 1.
    Axis axis(std::size_t node) const { return cut_[node].place == 0 ? Axis::x : Axis::y; }

    // The part of the plane that is a cell.
    Cell region(std::size_t cell) const;

    std::size_t cell(Point p) const { return cells(Abreast<1>{{{p.x, p.y}}})[0]; }

    // Several points descend the tree in lockstep, which hides latency.
    template <std::size_t N>
    std::array<std::uint32_t, N> cells(const Abreast<N>& points) const {
        std::array<std::uint32_t, N> node;
        node.fill(1);
        for (int level = 0; level < depth_; ++level)
            for (std::size_t i = 0; i < N; ++i)
                node[i] = 2 * node[i] + !cut_[node[i]].is_after(points[i]);
        for (std::uint32_t& n : node) n -= static_cast<std::uint32_t>(cells());
        return node;
    }

 private:
    // The points below a value are on the left of the cut.
    struct Cut {
        double value = 0;
        std::size_t place = 0;  // the index of the coordinate

        bool is_after(const Coordinates& p) const { return p[place] < value; }
    };
    // Finds the cut of a node in its part of the sample, and divides that part.
    Point* cut(std::size_t node, Point* first, Point* last);
    void learn(std::size_t node, int level, Point* first, Point* last);

    int depth_;
    std::vector<Cut> cut_;  // of each node
};

}  // namespace liftmesh
