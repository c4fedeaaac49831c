#include "apollonius/insertion_order.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "sorting/hilbert.hpp"
#include "sorting/sample.hpp"

namespace liftmesh::apollonius {

namespace {

// Maps coordinates to a grid whose lines lie more densely where the disks do, so that one disk far
// away, or clusters, leave no cell with many disks.
class Axis {
 public:
    Axis(const std::vector<Disk>& disks, double Disk::* coordinate) {
        const std::size_t count = std::min(disks.size(), most_lines);
        for (std::size_t i = 0; i < count; ++i)
            lines_.push_back(disks[sample_place(i, disks.size())].*coordinate);
        std::sort(lines_.begin(), lines_.end());
    }

    std::uint32_t cell(double value) const {
        const auto after = std::upper_bound(lines_.begin(), lines_.end(), value);
        double place = static_cast<double>(after - lines_.begin());
        if (after != lines_.begin() && after != lines_.end())
            // Halves, so that no difference overflows.
            place += (value / 2 - after[-1] / 2) / (*after / 2 - after[-1] / 2);
        const double share = place / static_cast<double>(lines_.size() + 1);
        return static_cast<std::uint32_t>(std::fmin(share, 1) * 65535);
    }

 private:
    static constexpr std::size_t most_lines = 1024;
    std::vector<double> lines_;
};

}  // namespace

std::vector<Row> insertion_order(const std::vector<Disk>& disks, std::uint64_t secret) {
    const Axis across(disks, &Disk::x), up(disks, &Disk::y);
    std::vector<std::pair<std::uint64_t, Row>> keys;
    keys.reserve(disks.size());
    Row largest = 0;
    for (Row i = 0; i < disks.size(); ++i) {
        // Early rounds have many trailing zeros.
        const int later = 63 - std::min(std::countr_zero(random_number(i, secret)), 63);
        const std::uint32_t place =
            place_on_hilbert_curve(across.cell(disks[i].x), up.cell(disks[i].y));
        keys.emplace_back(static_cast<std::uint64_t>(later) << 32 | place, i);
        if (disks[i].r > disks[largest].r) largest = i;
    }
    std::sort(keys.begin(), keys.end());
    std::vector<Row> order;
    order.reserve(disks.size());
    if (!disks.empty()) order.push_back(largest);
    for (const auto& [key, row] : keys)
        if (row != largest) order.push_back(row);
    return order;
}

}  // namespace liftmesh::apollonius
