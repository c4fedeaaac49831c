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

// A table that lives for one cell; positions are looked up among the points already kept.
std::size_t by_hash(Point* points, Row* rows, std::size_t count,
                    std::vector<Duplicate>& duplicates) {
    constexpr std::size_t on_stack = 1024;
    const std::size_t size = std::bit_ceil(2 * count);
    std::uint32_t small[on_stack];
    std::vector<std::uint32_t> large(size > on_stack ? size : 0);
    std::uint32_t* table = size > on_stack ? large.data() : small;
    std::fill_n(table, size, nothing);

    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Point p = points[i];
        std::size_t slot = hash(p) & (size - 1);
        while (table[slot] != nothing && !(points[table[slot]] == p))
            slot = (slot + 1) & (size - 1);
        if (table[slot] != nothing) {
            duplicates.push_back({rows[i], rows[table[slot]]});
            continue;
        }
        table[slot] = static_cast<std::uint32_t>(kept);
        points[kept] = p;
        rows[kept++] = rows[i];
    }
    return kept;
}

// For a crowded cell: no input makes sorting quadratic.
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

std::size_t keep_distinct(Point* points, Row* rows, std::size_t count,
                          std::vector<Duplicate>& duplicates) {
    constexpr std::size_t crowded = std::size_t{1} << 16;
    return count < crowded ? by_hash(points, rows, count, duplicates)
                           : by_sorting(points, rows, count, duplicates);
}

}  // namespace liftmesh
