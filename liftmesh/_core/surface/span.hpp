// The pixels of one row that lie in one face, by three linear functions of the column.
//
// For each side of the face, the determinant that is positive inside is linear in the column, but
// for the rounding of centres and of the determinant itself. Twice a bound on both is added and
// subtracted: between the outer bounds lie all pixels of the closed face, between the inner ones
// only such pixels. The few in between are left to exact orientations. So no pixel rests on a
// rounded bound, for rotated rasters as for others.
//
// The bound: let `far` be the sum of all magnitudes that occur in a centre, or that of a corner if
// that is larger, and e = 2^-53. A centre is off by at most 3 e far in x and y, a difference of two
// points by 4 e far more, and the slope of the function, times the columns, by 4 e far; each is
// multiplied by the extents of the side. All this is less than 2^-48 (|dx| + |dy|) far.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/input.hpp"
#include "surface/grid.hpp"

namespace liftmesh {

// Columns, or rows; both ends included.
struct Interval {
    std::int32_t first, last;

    bool is_empty() const { return first > last; }
};

struct PixelBox {
    Interval columns, rows;

    bool is_empty() const { return columns.is_empty() || rows.is_empty(); }
};

// From the plane to pixels.
class PixelFinder {
 public:
    explicit PixelFinder(const Grid& grid) : grid_(grid), largest_(grid.largest()) {
        const double left = grid.a * grid.e, right = grid.b * grid.d, det = left - right;
        column_x_ = grid.e / det, column_y_ = -grid.b / det;
        row_x_ = -grid.d / det, row_y_ = grid.a / det;
        // The determinant has a relative error, which is large where its products nearly cancel.
        const double size = std::fabs(left) + std::fabs(right);
        share_ = 0x1p-46 + 0x1p-49 * (size / std::fabs(det));
        is_known_ = std::fabs(det) > 1e-250 && size < 1e250 && share_ < 0x1p-10;
    }

    const Grid& grid() const { return grid_; }

    // The largest magnitude that matters to a triangle.
    double far(const Point (&corners)[3]) const {
        double largest = largest_;
        for (const Point& p : corners)
            largest = std::max({largest, std::fabs(p.x), std::fabs(p.y)});
        return largest;
    }

    // No other pixel has its centre in the triangle. All are in the box of transforms that are too
    // skew, too small or too large for doubles to be turned round.
    PixelBox box(const Point (&corners)[3], double far) const {
        double left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
        bool known = is_known_;
        for (const Point& p : corners) {
            const double x = p.x - grid_.c, y = p.y - grid_.f;
            const double column = x * column_x_ + y * column_y_, row = x * row_x_ + y * row_y_;
            known &= std::isfinite(column) & std::isfinite(row);
            left = std::min(left, column), right = std::max(right, column);
            top = std::min(top, row), bottom = std::max(bottom, row);
        }
        if (!known) return are_finite(corners) ? all() : PixelBox{{0, -1}, {0, -1}};
        const double first = grid_.first_row;
        return {pixels(left, right, (std::fabs(column_x_) + std::fabs(column_y_)) * far * share_,
                       grid_.columns),
                pixels(top - first, bottom - first,
                       (std::fabs(row_x_) + std::fabs(row_y_)) * far * share_, grid_.rows)};
    }

 private:
    // They are, unless other threads write the rows.
    static bool are_finite(const Point (&corners)[3]) {
        return is_finite(corners[0]) && is_finite(corners[1]) && is_finite(corners[2]);
    }
    PixelBox all() const { return {{0, grid_.columns - 1}, {0, grid_.rows - 1}}; }

    static Interval pixels(double low, double high, double room, std::int32_t count) {
        const double first = std::min(std::max(low - 0.5 - room, 0.0), double{1} * count);
        const double last = std::max(std::min(high - 0.5 + room, count - 1.0), -1.0);
        const auto whole = static_cast<std::int32_t>(first);
        return {whole + (whole < first), static_cast<std::int32_t>(last + 1) - 1};
    }

    Grid grid_;
    double largest_, column_x_, column_y_, row_x_, row_y_, share_;
    bool is_known_;
};

// The columns of a row: all that may be in the face, and those that surely are.
struct RowSpan {
    Interval possible, sure;
};

class Spans {
 public:
    Spans(const Grid& grid, const Point (&corners)[3], const PixelBox& box, double far)
        : grid_(grid), first_(box.columns.first), width_(box.columns.last - box.columns.first) {
        for (int k = 0; k < 3; ++k) add_side(corners[(k + 1) % 3], corners[(k + 2) % 3], far);
    }

    RowSpan at(std::int32_t row) const {
        if (is_unknown_) return {{first_, first_ + width_}, {first_ + 1, first_}};
        const Point start = grid_.centre(row, first_);
        double low = -1, high = width_ + 1.0;
        for (int i = 0; i < lower_; ++i) low = std::max(low, sides_[i].crossing(start));
        for (int i = upper_; i < 3; ++i) high = std::min(high, sides_[i].crossing(start));
        double sure_high = high - slack_;
        if (has_level_ && !(level_.at(start) > level_.bound)) sure_high = -1;
        // The offsets strictly between the inner bounds.
        return {{first_ + ceil(std::max(low - slack_, 0.0)),
                 first_ + floor(std::min(high + slack_, double{1} * width_))},
                {first_ + floor(low + slack_) + 1, first_ + ceil(sure_high) - 1}};
    }

 private:
    struct Side {
        double x, y, dx, dy, inverse, bound;

        double at(Point start) const { return dx * (start.y - y) - dy * (start.x - x); }
        double crossing(Point start) const { return -at(start) * inverse; }
    };

    // Of offsets from -1 to one beyond the last.
    int floor(double offset) const { return static_cast<int>(kept(offset) + 1) - 1; }
    int ceil(double offset) const {
        const double x = kept(offset) + 1;
        const auto whole = static_cast<int>(x);
        return whole + (whole < x) - 1;
    }
    double kept(double offset) const { return std::min(std::max(offset, -1.0), width_ + 1.0); }

    // Sides that bound the columns from below come first, those from above last. A level one, along
    // the rows, has all pixels of a row on one side.
    void add_side(Point tail, Point head, double far) {
        const double dx = head.x - tail.x, dy = head.y - tail.y;
        const double step = dx * grid_.d - dy * grid_.a, inverse = 1 / step;
        const double bound = (std::fabs(dx) + std::fabs(dy)) * far * 0x1p-45 + 1e-290;
        const double slack = bound * std::fabs(inverse);
        const Side side{tail.x, tail.y, dx, dy, inverse, bound};
        // What `at` gives is less than 2^46 times the bound, so crossings are finite.
        if (bound < 1e290 && std::fabs(inverse) < 1e290 && slack < 1e290) {
            sides_[step > 0 ? lower_++ : --upper_] = side;
            slack_ = std::max(slack_, slack);
        } else {
            is_unknown_ |= step != 0 || has_level_ || !(bound < 1e290);
            has_level_ = true;
            level_ = side;
        }
    }

    const Grid& grid_;
    std::int32_t first_, width_;
    int lower_ = 0, upper_ = 3;
    bool is_unknown_ = false, has_level_ = false;
    double slack_ = 0;  // of the offsets where a row crosses sides, the largest of the sides'
    Side sides_[3], level_;
};

}  // namespace liftmesh
