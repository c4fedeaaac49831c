#include "simplification/grid.hpp"

namespace liftmesh::simplification {

namespace {

constexpr double most_slack = 1e-3;
constexpr std::size_t most_cells_per_point = 4;

// Distinct numbers in the order of their arrival, and a hash table of them. In a raster the next
// number is nearly always that of the last call, or the one which came after it.
class Distinct {
 public:
    Distinct() : table_(std::size_t{1} << (64 - shift_), none) {}

    std::uint32_t index(double value) {
        for (const std::uint32_t likely : {last_, last_ + 1})
            if (likely < values_.size() && values_[likely] == value) return last_ = likely;
        std::uint32_t& entry = table_[slot(value)];
        if (entry != none) return last_ = entry;
        last_ = entry = static_cast<std::uint32_t>(values_.size());
        values_.push_back(value);
        if (2 * values_.size() > table_.size()) grow();
        return last_;
    }
    std::size_t count() const { return values_.size(); }

    // Sorts them, and returns the place of each.
    std::vector<std::uint32_t> sort(std::vector<double>& sorted) const {
        std::vector<std::uint32_t> order(values_.size()), places(values_.size());
        std::iota(order.begin(), order.end(), std::uint32_t{0});
        std::sort(order.begin(), order.end(),
                  [&](std::uint32_t i, std::uint32_t k) { return values_[i] < values_[k]; });
        sorted.resize(values_.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) {
            places[order[i]] = i;
            sorted[i] = values_[order[i]];
        }
        return places;
    }

 private:
    std::size_t slot(double value) const {
        const std::uint64_t mixed = std::bit_cast<std::uint64_t>(value) * 0x9e3779b97f4a7c15u;
        std::size_t at = mixed >> shift_;
        while (table_[at] != none && values_[table_[at]] != value)
            at = (at + 1) & (table_.size() - 1);
        return at;
    }
    void grow() {
        --shift_;
        table_.assign(2 * table_.size(), none);
        for (std::uint32_t i = 0; i < values_.size(); ++i) table_[slot(values_[i])] = i;
    }

    int shift_ = 56;  // leaves the upper bits of a hash, as many as the table has
    std::vector<double> values_;
    std::vector<std::uint32_t> table_;
    std::uint32_t last_ = 0;
};

// By how much lines are off from even distances, as a part of these.
double slack(const std::vector<double>& lines) {
    const double step = (lines.back() - lines.front()) / static_cast<double>(lines.size() - 1);
    double most = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const double off = lines[i] - (lines.front() + static_cast<double>(i) * step);
        // Overflow is no grid.
        if (!(std::fabs(off) <= most_slack * step)) return std::numeric_limits<double>::infinity();
        most = std::fmax(most, std::fabs(off) / step);
    }
    return most;
}

}  // namespace

std::optional<Grid> Grid::of(const Terrain& terrain) {
    const std::size_t most = std::min(most_cells_per_point * terrain.count, std::size_t{none} - 1);
    Distinct xs, ys;
    for (std::size_t i = 0; i < terrain.count; ++i) {
        xs.index(terrain.points[i].x);
        ys.index(terrain.points[i].y);
        if (xs.count() * ys.count() > most) return std::nullopt;
    }
    std::vector<double> sorted_xs, sorted_ys;
    const std::vector<std::uint32_t> columns = xs.sort(sorted_xs), rows = ys.sort(sorted_ys);
    Grid grid(std::move(sorted_xs), std::move(sorted_ys));
    grid.inverse_ = ~std::uint64_t{0} / ys.count() + 1;
    grid.slack_ = std::fmax(slack(grid.xs_), slack(grid.ys_));
    if (!(grid.slack_ <= most_slack)) return std::nullopt;
    const std::size_t cells = xs.count() * ys.count();
    grid.is_full_ = cells == terrain.count;
    grid.heights_.resize(cells);
    grid.rows_.resize(cells, none);
    for (std::size_t i = 0; i < terrain.count; ++i) {
        const Point p = terrain.points[i];
        const std::size_t cell = columns[xs.index(p.x)] * ys.count() + rows[ys.index(p.y)];
        grid.heights_[cell] = terrain.heights[i];
        grid.rows_[cell] = static_cast<Row>(i);
    }
    return grid;
}

std::vector<std::uint32_t> Grid::of_rows(const std::vector<Row>& rows) const {
    std::vector<std::uint32_t> place(*std::max_element(rows.begin(), rows.end()) + std::size_t{1},
                                     none);
    for (std::uint32_t s = 0; s < rows_.size(); ++s)
        if (rows_[s] < place.size()) place[rows_[s]] = s;
    std::vector<std::uint32_t> found;
    for (const Row row : rows) found.push_back(place[row]);
    return found;
}

}  // namespace liftmesh::simplification
