// The pixels of each row that lie in one face, by three linear functions of column and row.
//
// For each side of the face, the determinant that is positive inside is linear in the column and
// the row, but for the rounding of centres and of the function itself. Twice a bound on both is
// added and subtracted: between the outer bounds lie all pixels of the closed face, between the
// inner ones only such pixels. The few in between are left to exact orientations. So no pixel rests
// on a rounded bound, for rotated rasters as for others.
//
// The bound: let `far` be the sum of all magnitudes that occur in a centre, or that of a corner if
// that is larger, and e = 2^-53. In units of e far (|dx| + |dy|), with the extents of the side, the
// centres of a pixel and of the first one are off by 3 each, the determinant of the latter by 8,
// the slopes along columns and rows, times their numbers, by 3 each. Where a row crosses the side
// is a sum of quotients, off by 10 more, and its distance from an end of the columns by 4. All this
// is less than 2^-46 far (|dx| + |dy|).
#pragma once

#include "base/input.hpp"
#include "base/pair.hpp"
#include "base/point.hpp"

namespace liftmesh {

// A raster: rows and columns of pixels, whose centres an affine transform puts in the plane.

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
            known &= is_finite(Point{column, row});
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

// Of consecutive rows: the first and the last column that may be in the face, and the first and the
// last that surely are.
struct RowSpans {
    static constexpr std::int32_t most = 64;

    std::int32_t first[most], last[most], sure_first[most], sure_last[most];
    bool are_sure;  // whether all rows surely are

    Interval possible(std::int32_t i) const { return {first[i], last[i]}; }
    Interval sure(std::int32_t i) const { return {sure_first[i], sure_last[i]}; }
    bool is_sure(std::int32_t i) const {
        return ((first[i] ^ sure_first[i]) | (last[i] ^ sure_last[i])) == 0;
    }
};

class Spans {
 public:
    Spans(const Grid& grid, const Point (&corners)[3], const PixelBox& box, double far)
        : columns_(box.columns),
          row_(box.rows.first),
          end_(double{1} * box.columns.last - box.columns.first + 1) {
        lower_[0] = lower_[1] = {-1, 0};
        upper_[0] = upper_[1] = {end_, 0};
        const Point start = grid.centre(row_, columns_.first);
        for (int k = 0; k < 3; ++k)
            add_side(grid, start, corners[(k + 1) % 3], corners[(k + 2) % 3], far);
    }

    // Of `count` rows from `row` on.
    void put(std::int32_t row, std::int32_t count, RowSpans& spans) const {
        Ints doubt = both(is_unknown_);
        for (std::int32_t i = 0; i < count; i += 2) {
            if (is_unknown_)
                put_all(i, spans);
            else
                doubt |= put_two(Pair{0, 1} + spread<Pair>(double{1} * (row - row_) + i), i, spans);
        }
        spans.are_sure = (doubt[0] | doubt[1]) == 0;
    }

 private:
    // Of the row, counted from the first of the box.
    struct Line {
        double start, slope;

        Pair at(Pair row) const { return spread<Pair>(start) + row * spread<Pair>(slope); }
    };

    // Offsets from the first column; -1 and `end_` stand for all beyond. What is rounded down is
    // never negative: a lower end is rounded up as its distance from `end_`. Returns zeros if both
    // rows are sure.
    Ints put_two(Pair row, std::int32_t i, RowSpans& spans) const {
        const Pair low = greatest(lower_[0].at(row), lower_[1].at(row));
        const Pair high = least(upper_[0].at(row), upper_[1].at(row));
        const Pair to_end = spread<Pair>(end_ + slack_), from_start = spread<Pair>(1 + slack_);
        Pair behind = to_end - high;
        if (has_level_) behind = level_.at(row) > spread<Pair>(level_bound_) ? behind : to_end;
        const std::int32_t first = columns_.first, last = columns_.last;
        const Ints begin = both(last + 1) - whole(to_end - low);
        const Ints end = both(first - 1) + whole(from_start + high);
        const Ints sure_begin = both(first) + whole(from_start + low);
        const Ints sure_end = both(last) - whole(behind);
        store(begin, spans.first + i);
        store(end, spans.last + i);
        store(sure_begin, spans.sure_first + i);
        store(sure_end, spans.sure_last + i);
        return (begin ^ sure_begin) | (end ^ sure_end);
    }
    void put_all(std::int32_t i, RowSpans& spans) const {
        for (const std::int32_t at : {i, i + 1}) {
            spans.first[at] = spans.sure_first[at] = columns_.first;
            spans.last[at] = columns_.last;
            spans.sure_last[at] = columns_.first - 1;
        }
    }
    Ints whole(Pair offset) const {
        return truncated(least(greatest(offset, Pair{0, 0}), spread<Pair>(end_)));
    }

    // One along the rows, a level one, has all pixels of a row on one side.
    void add_side(const Grid& grid, Point start, Point tail, Point head, double far) {
        const double dx = head.x - tail.x, dy = head.y - tail.y;
        const double at = dx * (start.y - tail.y) - dy * (start.x - tail.x);
        const double along = dx * grid.d - dy * grid.a, across = dx * grid.e - dy * grid.b;
        const double bound = (std::fabs(dx) + std::fabs(dy)) * far * 0x1p-45 + 1e-290;
        const double inverse = 1 / along, slack = bound * std::fabs(inverse);
        is_unknown_ |= !(bound < 1e290);
        if (slack < most_slack) {
            int& sides = along > 0 ? lowers_ : uppers_;
            is_unknown_ |= sides == 2;
            (along > 0 ? lower_ : upper_)[sides++ % 2] = {-at * inverse, -across * inverse};
            slack_ = std::max(slack_, slack);
        } else {
            is_unknown_ |= along != 0 || has_level_;
            has_level_ = true;
            level_ = {at, across};
            level_bound_ = bound;
        }
    }

    static constexpr double most_slack = 0x1p31;  // columns

    Interval columns_;
    std::int32_t row_;
    double end_;
    int lowers_ = 0, uppers_ = 0;
    bool is_unknown_ = false, has_level_ = false;
    double slack_ = 0;  // of the offsets where a row crosses sides, the largest of the sides'
    Line lower_[2], upper_[2], level_{};
    double level_bound_ = 0;
};

}  // namespace liftmesh
