// A raster: rows and columns of pixels, whose centres an affine transform puts in the plane.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/pair.hpp"
#include "base/point.hpp"

namespace liftmesh {

// Two points, x and y apart.
struct Pairs {
    Pair x, y;
};

struct Grid {
    double a, b, c, d, e, f;
    std::int32_t first_row, rows, columns;  // a window of whole rows

    std::size_t pixels() const {
        return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    }
    std::size_t pixel(std::int32_t row, std::int32_t column) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(column);
    }
    // As rounded: every answer about a pixel is one about this point.
    Point centre(std::int32_t row, std::int32_t column) const {
        const double u = column + 0.5, v = first_row + row + 0.5;
        return {a * u + b * v + c, d * u + e * v + f};
    }
    // Of a column and the one after it.
    Pairs centres(std::int32_t row, std::int32_t column) const {
        const Pair u = Pair{0.5, 1.5} + spread<Pair>(column);
        const double v = first_row + row + 0.5;
        return {spread<Pair>(a) * u + spread<Pair>(b * v) + spread<Pair>(c),
                spread<Pair>(d) * u + spread<Pair>(e * v) + spread<Pair>(f)};
    }
    // No coordinate that occurs in `centre`, nor any in between, is larger.
    double largest() const {
        return std::fabs(c) + std::fabs(f) + (std::fabs(a) + std::fabs(d)) * columns +
               (std::fabs(b) + std::fabs(e)) * (first_row + double{1} * rows);
    }
};

}  // namespace liftmesh
