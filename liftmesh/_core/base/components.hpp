// Which of so many things are connected: union-find with path halving (R. E. Tarjan and J. van
// Leeuwen, 1984).
#pragma once

#include "base/standard.hpp"

namespace liftmesh {

class Components {
 public:
    explicit Components(std::size_t count) : parent_(count, none) {}

    std::size_t count() const { return count_; }
    bool has(std::size_t i) const { return parent_[i] != none; }
    void add(std::size_t i) {
        parent_[i] = static_cast<std::uint32_t>(i);
        ++count_;
    }
    // Of two that were added: whether they were apart.
    bool join(std::size_t i, std::size_t j) {
        const std::uint32_t a = root(i), b = root(j);
        if (a == b) return false;
        parent_[std::max(a, b)] = std::min(a, b);
        --count_;
        return true;
    }

 private:
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    std::uint32_t root(std::size_t i) {
        auto at = static_cast<std::uint32_t>(i);
        while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
        return at;
    }

    std::vector<std::uint32_t> parent_;
    std::size_t count_ = 0;
};

}  // namespace liftmesh
