#include "cells/spokes.hpp"

#include <algorithm>

namespace liftmesh {

namespace {

constexpr int after(int k) {
    return k == 2 ? 0 : k + 1;
}
constexpr int before(int k) {
    return k == 0 ? 2 : k - 1;
}

}  // namespace

Spokes::Spokes(const Dual& dual, const std::int32_t* chain, std::size_t length)
    : dual_(dual), chain_(chain), length_(length), first_(allocate<std::int32_t>(dual.rows)) {
    std::fill_n(first_.get(), dual.rows, none);
    for (std::size_t i = 0; i < length; ++i) first_[chain[i]] = static_cast<std::int32_t>(i);
    // At a row on the hull, the triangle from which all others are reached counter-clockwise.
    for (std::size_t t = 0; t < dual.count; ++t)
        for (int k = 0; k < 3; ++k) {
            std::int32_t& first = first_[dual.vertex(static_cast<std::int32_t>(t), k)];
            if (first == none || dual.neighbor(static_cast<std::int32_t>(t), before(k)) == none)
                first = static_cast<std::int32_t>(t);
        }
}

void Spokes::list(std::int32_t row, std::vector<Spoke>& found) const {
    found.clear();
    const std::int32_t start = first_[row];
    if (length_ > 0) {
        if (start > 0) found.push_back({chain_[start - 1], none});
        if (static_cast<std::size_t>(start) + 1 < length_)
            found.push_back({chain_[start + 1], none});
        return;
    }
    std::int32_t t = start, next = start;
    do {
        t = next;
        const int k = dual_.place(t, row);
        found.push_back({dual_.vertex(t, after(k)), t});
        next = dual_.neighbor(t, after(k));
        if (next == none) found.push_back({dual_.vertex(t, before(k)), none});
    } while (next != none && next != start);
}

std::int32_t Spokes::any() const {
    if (length_ > 0) return chain_[0];
    return dual_.count > 0 ? dual_.vertex(0, 0) : none;
}

}  // namespace liftmesh
