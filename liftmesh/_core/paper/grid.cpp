#include "paper/grid.hpp"

namespace liftmesh::paper {

namespace {

constexpr double points_per_cell = 1;

Box bounds_of(std::span<const Site> sites) {
    const Point first = sites.front().point;
    Box box{first.x, first.x, first.y, first.y};
    for (const Site& site : sites) {
        box.min_x = std::min(box.min_x, site.point.x);
        box.max_x = std::max(box.max_x, site.point.x);
        box.min_y = std::min(box.min_y, site.point.y);
        box.max_y = std::max(box.max_y, site.point.y);
    }
    return box;
}

// Square cells, as far as the proportions of the box allow.
std::size_t columns_for(const Box& box, double cells) {
    const double width = box.max_x - box.min_x, height = box.max_y - box.min_y;
    const double wanted = std::sqrt(cells) * std::sqrt(width / height);
    return wanted >= 1 ? static_cast<std::size_t>(std::min(wanted, cells)) : 1;
}

}  // namespace

Grid::Grid(std::span<Site> sites) : bounds_(bounds_of(sites)) {
    const double cells = std::max(1.0, static_cast<double>(sites.size()) / points_per_cell);
    const std::size_t columns = columns_for(bounds_, cells);
    const auto lines =
        static_cast<std::size_t>(std::max(1.0, std::ceil(cells / static_cast<double>(columns))));
    columns_ = Cells(bounds_.min_x, bounds_.max_x, columns);
    lines_ = Cells(bounds_.min_y, bounds_.max_y, lines);

    starts_.assign(columns * lines + 1, 0);
    for (const Site& site : sites) ++starts_[cell(site.point) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    std::vector<std::uint32_t> cursor(starts_.begin(), starts_.end() - 1);
    const std::vector<Site> unsorted(sites.begin(), sites.end());
    for (const Site& site : unsorted) sites[cursor[cell(site.point)]++] = site;
}

}  // namespace liftmesh::paper
