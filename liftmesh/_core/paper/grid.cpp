#include "paper/grid.hpp"

namespace liftmesh::paper {

namespace {

constexpr double points_per_cell = 1;

Box bounds_of(const std::vector<Point>& points) {
    Box box{points[0].x, points[0].x, points[0].y, points[0].y};
    for (const Point& p : points) {
        box.min_x = std::min(box.min_x, p.x);
        box.max_x = std::max(box.max_x, p.x);
        box.min_y = std::min(box.min_y, p.y);
        box.max_y = std::max(box.max_y, p.y);
    }
    return box;
}

// Square cells, as far as the sides of the box allow.
std::size_t columns_for(const Box& box, double cells) {
    const double width = box.max_x - box.min_x, height = box.max_y - box.min_y;
    const double wanted = std::sqrt(cells) * std::sqrt(width / height);
    return wanted >= 1 ? static_cast<std::size_t>(std::min(wanted, cells)) : 1;
}

}  // namespace

Grid::Grid(std::vector<Point>& points, std::vector<Row>& rows) : bounds_(bounds_of(points)) {
    const double cells = std::max(1.0, static_cast<double>(points.size()) / points_per_cell);
    const std::size_t columns = columns_for(bounds_, cells);
    const auto lines =
        static_cast<std::size_t>(std::max(1.0, std::ceil(cells / static_cast<double>(columns))));
    columns_ = Cells(bounds_.min_x, bounds_.max_x, columns);
    lines_ = Cells(bounds_.min_y, bounds_.max_y, lines);

    starts_.assign(columns * lines + 1, 0);
    for (const Point& p : points) ++starts_[cell(p) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    std::vector<std::uint32_t> cursor(starts_.begin(), starts_.end() - 1);
    std::vector<Point> sorted_points(points.size());
    std::vector<Row> sorted_rows(rows.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::uint32_t at = cursor[cell(points[i])]++;
        sorted_points[at] = points[i];
        sorted_rows[at] = rows[i];
    }
    points.swap(sorted_points);
    rows.swap(sorted_rows);
}

}  // namespace liftmesh::paper
