// The caller's rows, read in place: float64 or float32, any strides.
#pragma once

#include "base/buffer.hpp"
#include "base/point.hpp"

namespace liftmesh {

struct Input {
    const std::byte* data;
    std::size_t rows;
    std::ptrdiff_t row_stride, column_stride;  // in bytes
    bool single_precision;

    // Whether a row is two doubles, one after the other, and the next row follows.
    bool is_plain() const {
        return !single_precision && row_stride == sizeof(Point) && column_stride == sizeof(double);
    }

    // Adding zero turns -0.0 into 0.0: the two are one position.
    Point operator[](std::size_t row) const {
        const std::byte* at = data + static_cast<std::ptrdiff_t>(row) * row_stride;
        if (single_precision)
            return {value<float>(at) + 0.0, value<float>(at + column_stride) + 0.0};
        return {value<double>(at) + 0.0, value<double>(at + column_stride) + 0.0};
    }

    [[gnu::always_inline]] void prefetch(std::size_t row) const {
        liftmesh::prefetch(data + static_cast<std::ptrdiff_t>(row) * row_stride);
    }

    // The third column.
    double height(std::size_t row) const {
        const std::byte* at =
            data + static_cast<std::ptrdiff_t>(row) * row_stride + 2 * column_stride;
        return (single_precision ? value<float>(at) : value<double>(at)) + 0.0;
    }

 private:
    template <class Real>
    static double value(const std::byte* at) {
        return static_cast<double>(*reinterpret_cast<const Real*>(at));
    }
};

inline bool is_finite(Point p) {
    return (int{std::isfinite(p.x)} & int{std::isfinite(p.y)}) != 0;
}

}  // namespace liftmesh
