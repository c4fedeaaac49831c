// The edges at a site, counter-clockwise, and what lies between each and the next: a triangle, or
// nothing. They are dual to the ridges around its cell, and the triangles to its corners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/buffer.hpp"
#include "cells/diagram.hpp"

namespace liftmesh {

struct Spoke {
    std::int32_t row;
    std::int32_t triangle;  // before the next spoke; -1 at infinity
};

// A chain of rows instead of triangles has those on one line, in their order.
class Spokes {
 public:
    Spokes(const Dual& dual, const std::int32_t* chain, std::size_t length);

    bool has(std::int32_t row) const { return first_[row] != none; }
    // Replaces what is in `found`.
    void list(std::int32_t row, std::vector<Spoke>& found) const;
    // A row with a cell; -1 if there is none.
    std::int32_t any() const;

 private:
    static constexpr std::int32_t none = -1;

    const Dual& dual_;
    const std::int32_t* chain_;
    std::size_t length_;
    Buffer<std::int32_t> first_;  // the first triangle at a row, or its place in the chain
};

}  // namespace liftmesh
