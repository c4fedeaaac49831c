#include "distinct.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>

namespace liftmesh {

namespace {

constexpr std::uint32_t nothing = ~std::uint32_t{0};

// The finishing steps of SplitMix64 (Steele, Lea and Flood 2014) after each coordinate: the bits in
// which the coordinates of a lattice differ are few, and the highest.
std::uint64_t mixed(std::uint64_t h) {
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

std::uint64_t hash(Point p) {
    return mixed(mixed(std::bit_cast<std::uint64_t>(p.x)) ^ std::bit_cast<std::uint64_t>(p.y));
}

// Where collisions are more than chance explains, the answer is left to sorting: no input makes
// this quadratic.
class Table {
 public:
    explicit Table(std::size_t count) : mask_(std::bit_ceil(2 * count) - 1), patience_(16 * count) {
        if (mask_ >= on_stack) large_.resize(mask_ + 1);
        slots_ = mask_ >= on_stack ? large_.data() : small_;
        std::fill_n(slots_, mask_ + 1, nothing);
    }

    // The slot that holds the position, or the empty one where it belongs.
    std::uint32_t& find(Point p, const Point* kept) {
        std::size_t slot = hash(p) & mask_;
        while (slots_[slot] != nothing && !(kept[slots_[slot]] == p)) {
            slot = (slot + 1) & mask_;
            --patience_;
        }
        return slots_[slot];
    }
    bool is_clogged() const { return patience_ < 0; }

 private:
    static constexpr std::size_t on_stack = 1024;

    std::size_t mask_;
    std::ptrdiff_t patience_;
    std::uint32_t small_[on_stack];
    std::vector<std::uint32_t> large_;
    std::uint32_t* slots_;
};

std::size_t by_sorting(Point* points, Row* rows, std::size_t count,
                       std::vector<Duplicate>& duplicates) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        return points[i] == points[j] ? i < j : before_xy(points[i], points[j]);
    });
    std::vector<bool> repeated(count);
    for (std::size_t i = 1, first = 0; i < count; ++i) {
        if (!(points[order[i]] == points[order[first]])) {
            first = i;
            continue;
        }
        repeated[order[i]] = true;
        duplicates.push_back({rows[order[i]], rows[order[first]]});
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (repeated[i]) continue;
        points[kept] = points[i];
        rows[kept++] = rows[i];
    }
    return kept;
}

}  // namespace

// A table that lives for one cell; positions are looked up among the points already kept.
std::size_t keep_distinct(Point* points, Row* rows, std::size_t count,
                          std::vector<Duplicate>& duplicates) {
    Table table(count);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t& slot = table.find(points[i], points);
        if (slot != nothing) {
            duplicates.push_back({rows[i], rows[slot]});
            continue;
        }
        slot = static_cast<std::uint32_t>(kept);
        points[kept] = points[i];
        rows[kept++] = rows[i];
        if (table.is_clogged()) {
            std::copy(points + i + 1, points + count, points + kept);
            std::copy(rows + i + 1, rows + count, rows + kept);
            return by_sorting(points, rows, kept + count - i - 1, duplicates);
        }
    }
    return kept;
}

}  // namespace liftmesh
