#include "sorting/kd_tree.hpp"

namespace liftmesh {

namespace {

TreeBox box_around(std::span<const Point> points, std::span<const Row> rows) {
    Point low = points[rows[0]], high = low;
    for (const Row row : rows) {
        const Point p = points[row];
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    // Roundings among the least doubles are off by half of one each.
    constexpr double outwards = 1 + 0x1p-50, least = 0x1p-1072;
    const auto half = [&](double from, double to) {
        const double reach = std::max(std::abs(from), std::abs(to));
        return (to - from) / 2 * outwards + reach * 0x1p-51 + least;
    };
    return {{low.x / 2 + high.x / 2, low.y / 2 + high.y / 2},
            {half(low.x, high.x), half(low.y, high.y)}};
}

}  // namespace

KdTree::KdTree(std::span<const Point> points, std::vector<Row> rows, Patience* patience)
    : rows_(std::move(rows)) {
    if (rows_.empty()) return;
    nodes_.reserve(rows_.size() / 2 + 1);
    build(points, 0, static_cast<std::uint32_t>(rows_.size()), patience);
    points_.reserve(rows_.size());
    for (const Row row : rows_) points_.push_back(points[row]);
}

void KdTree::build(std::span<const Point> points, std::uint32_t first, std::uint32_t last,
                   Patience* patience) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    const TreeBox box = box_around(points, std::span(rows_).subspan(first, last - first));
    nodes_.push_back({box, first, last, 0});
    if (last - first <= fewest || (patience && patience->ends(last - first))) return;
    const std::uint32_t middle = first + (last - first) / 2;
    const Axis axis = box.half.x >= box.half.y ? Axis::x : Axis::y;
    std::nth_element(rows_.begin() + first, rows_.begin() + middle, rows_.begin() + last,
                     [&](Row a, Row b) { return before(axis, points[a], points[b]); });
    build(points, first, middle, patience);
    nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
    build(points, middle, last, patience);
}

}  // namespace liftmesh
