#include "cuts.hpp"

#include <algorithm>

namespace liftmesh {

Cuts::Cuts(std::vector<Point> sample, int depth) : depth_(depth), cut_(cells()) {
    learn(1, 0, sample.data(), sample.data() + sample.size());
}

void Cuts::learn(std::size_t node, int level, Point* first, Point* last) {
    if (level == depth_) return;
    Point* middle = first + (last - first) / 2;
    std::nth_element(first, middle, last, axis(level) == Axis::x ? before_xy : before_yx);
    cut_[node] = *middle;
    learn(2 * node, level + 1, first, middle);
    learn(2 * node + 1, level + 1, middle, last);
}

}  // namespace liftmesh
