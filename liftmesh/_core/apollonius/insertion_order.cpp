#include "apollonius/insertion_order.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "sorting/sample.hpp"

namespace liftmesh::apollonius {

namespace {

// The place of a cell of a grid of 2^16 x 2^16 on Hilbert's curve.
std::uint64_t place_on_curve(std::uint32_t x, std::uint32_t y) {
    std::uint64_t place = 0;
    for (std::uint32_t half = 1u << 15; half != 0; half >>= 1) {
        const std::uint32_t right = (x & half) != 0, upper = (y & half) != 0;
        place = place << 2 | ((3 * right) ^ upper);
        if (upper) continue;
        if (right) x = ~x, y = ~y;
        std::swap(x, y);
    }
    return place;
}

class Grid {
 public:
    explicit Grid(const std::vector<Disk>& disks) {
        for (const Disk& d : disks) {
            low_ = {std::min(low_.x, d.x), std::min(low_.y, d.y)};
            high_ = {std::max(high_.x, d.x), std::max(high_.y, d.y)};
        }
    }
    std::uint64_t place(const Disk& d) const {
        return place_on_curve(cell(d.x, low_.x, high_.x), cell(d.y, low_.y, high_.y));
    }

 private:
    static std::uint32_t cell(double value, double low, double high) {
        return high > low ? static_cast<std::uint32_t>((value - low) / (high - low) * 65535.0) : 0;
    }
    Point low_{1, 1}, high_{-1, -1};
};

}  // namespace

std::vector<Row> insertion_order(const std::vector<Disk>& disks, std::uint64_t secret) {
    const Grid grid(disks);
    std::vector<std::pair<std::uint64_t, Row>> keys;
    keys.reserve(disks.size());
    Row largest = 0;
    for (Row i = 0; i < disks.size(); ++i) {
        // Early rounds have many trailing zeros.
        const int later = 63 - std::min(std::countr_zero(random_number(i, secret)), 63);
        keys.emplace_back(static_cast<std::uint64_t>(later) << 32 | grid.place(disks[i]), i);
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
