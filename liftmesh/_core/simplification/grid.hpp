// Samples on a grid: every column has the same rows, as in a raster, and some may be missing. Those
// of a triangle need no list: they are found column by column, between the edges below and above.
//
// Where an edge crosses a column is computed in doubles from the numbers of columns and rows. A
// grid whose coordinates are rounded has lines that are off by some slack, as a part of their
// distance; then a crossing is off by less than 8 times that, times 1 + |slope|. Where a sample is
// nearer to it than this, the exact turn decides on which side it is.
#pragma once

#include "base/buffer.hpp"
#include "base/status.hpp"
#include "dynamic/triangulation.hpp"
#include "simplification/samples.hpp"

namespace liftmesh::simplification {

class Grid {
 public:
    // Nothing if the points are on no grid, or on one that has few of them.
    static std::optional<Grid> of(const Terrain& terrain);

    const Turns& turns() const { return turns_; }
    std::size_t count() const { return heights_.size(); }
    Sample at(std::uint32_t s) const { return {point(place(s)), heights_[s]}; }
    Row row(std::uint32_t s) const { return rows_[s]; }
    std::vector<std::uint32_t> of_rows(const std::vector<Row>& rows) const;

    // A grid has nothing to keep when triangles change.
    bool deal(const dynamic::Triangulation&, Interrupt&) { return true; }
    void release(const dynamic::Triangulation&) {}
    void settle(const dynamic::Triangulation&, std::uint32_t) {}
    void release(const dynamic::Star&, std::uint32_t) {}
    void settle(const dynamic::Triangulation&, const dynamic::Patch&,
                const std::vector<TriangleId>&) {}

    // Their numbers are in the order of their coordinates.
    bool is_before(std::uint32_t s, std::uint32_t other) const { return s < other; }

    // Brings what is around one of them.
    [[gnu::always_inline]] void prefetch(std::uint32_t s) const {
        const auto height = static_cast<std::uint32_t>(ys_.size());
        liftmesh::prefetch(heights_.data() + s);
        liftmesh::prefetch(heights_.data() + (s < height ? s : s - height));
        liftmesh::prefetch(heights_.data() + (s + height < heights_.size() ? s + height : s));
    }

    // A triangle of half a cell has no samples but its corners (Pick's theorem). The doubled area
    // is computed from the numbers of lines: those of other samples and an edge are whole numbers,
    // and off by less than 16 times the slack times the size of the triangle.
    bool may_be_in(TriangleId, const std::uint32_t* corners) const;
    // Calls visit(s, sample) for those in a closed triangle, counter-clockwise, in the order of
    // their coordinates, until it returns false; whether it never did.
    template <class Visit>
    bool each_of(TriangleId, const std::uint32_t* corners, Visit visit) const;

    // Calls visit(i, s, sample) for those in the i-th triangle of a patch; number(v) is the sample
    // that a vertex is. One on an edge is visited for either side.
    template <class Number, class Visit>
    bool each_after(const dynamic::Triangulation&, const dynamic::Star&, std::uint32_t,
                    const dynamic::Patch& patch, Number number, Visit visit) const {
        for (std::size_t i = 0; i < patch.count(); ++i) {
            const Vertex* v = &patch.vertices[3 * i];
            if (v[0] == ghost || v[1] == ghost || v[2] == ghost) continue;
            const std::uint32_t corners[3] = {number(v[0]), number(v[1]), number(v[2])};
            const auto pass = [&](std::uint32_t s, const Sample& each) {
                return visit(i, s, each);
            };
            if (!each_of(dynamic::nothing, corners, pass)) return false;
        }
        return true;
    }

 private:
    __extension__ using Wide = unsigned __int128;

    struct Place {
        std::uint32_t column, row;
    };

    // An edge, from left to right.
    class Side {
     public:
        Side(const Grid& grid, Place left, Place right)
            : grid_(grid),
              left_(left),
              a_(grid.point(left)),
              b_(grid.point(right)),
              lowest_(std::min(left.row, right.row)),
              highest_(std::max(left.row, right.row)),
              slope_((static_cast<double>(right.row) - left.row) / (right.column - left.column)),
              margin_(1e-6 + 8 * grid.slack_ * (1 + std::fabs(slope_))) {}

        // The first sample of a column that is not below, and the last one that is not above.
        std::uint32_t first(std::uint32_t column) const {
            const double crossing = at(column), near = std::fmax(crossing - margin_, lowest_);
            auto row = static_cast<std::uint32_t>(near);
            row += row < near;
            if (row > crossing + margin_) return row;
            while (row < highest_ && turn(column, row) < 0) ++row;
            return row;
        }
        std::uint32_t last(std::uint32_t column) const {
            const double crossing = at(column), near = std::fmin(crossing + margin_, highest_);
            auto row = static_cast<std::uint32_t>(near);
            if (row < crossing - margin_) return row;
            while (row > lowest_ && turn(column, row) > 0) --row;
            return row;
        }

     private:
        double at(std::uint32_t column) const {
            return left_.row + (column - left_.column) * slope_;
        }
        int turn(std::uint32_t column, std::uint32_t row) const {
            return grid_.turns_(a_, b_, grid_.point({column, row}));
        }

        const Grid& grid_;
        Place left_;
        Point a_, b_;
        std::uint32_t lowest_, highest_;
        double slope_, margin_;
    };

    Grid(std::vector<double> xs, std::vector<double> ys)
        : turns_(xs, ys), xs_(std::move(xs)), ys_(std::move(ys)) {}

    Place place(std::uint32_t s) const {
        const auto column = static_cast<std::uint32_t>(Wide{s} * inverse_ >> 64);
        return {column, s - column * static_cast<std::uint32_t>(ys_.size())};
    }
    Point point(Place p) const { return {xs_[p.column], ys_[p.row]}; }

    template <class Visit>
    bool each_between(std::uint32_t column, std::uint32_t first, std::uint32_t last,
                      Visit& visit) const;

    Turns turns_;
    std::vector<double> xs_, ys_;
    std::vector<double> heights_;  // a column after the other
    std::vector<Row> rows_;        // of the caller, or `none`
    std::uint64_t inverse_ = 0;    // of the number of rows, times 2^64, rounded up
    double slack_ = 0;
    bool is_full_ = true;
};

inline bool Grid::may_be_in(TriangleId, const std::uint32_t* corners) const {
    const Place a = place(corners[0]), b = place(corners[1]), c = place(corners[2]);
    const double bx = static_cast<double>(b.column) - a.column;
    const double by = static_cast<double>(b.row) - a.row;
    const double cx = static_cast<double>(c.column) - a.column;
    const double cy = static_cast<double>(c.row) - a.row;
    if (bx * cy - by * cx != 1) return true;
    const double size = std::fabs(bx) + std::fabs(by) + std::fabs(cx) + std::fabs(cy);
    return !(32 * slack_ * size < 1);
}

template <class Visit>
bool Grid::each_between(std::uint32_t column, std::uint32_t first, std::uint32_t last,
                        Visit& visit) const {
    const auto start = static_cast<std::uint32_t>(column * ys_.size());
    const double x = xs_[column];
    for (std::uint32_t row = first; row <= last; ++row) {
        const std::uint32_t s = start + row;
        if (!is_full_ && rows_[s] == none) continue;
        if (!visit(s, Sample{{x, ys_[row]}, heights_[s]})) return false;
    }
    return true;
}

template <class Visit>
bool Grid::each_of(TriangleId, const std::uint32_t* corners, Visit visit) const {
    Place a = place(corners[0]), b = place(corners[1]), c = place(corners[2]);
    if (b.column < a.column && b.column <= c.column)
        std::tie(a, b, c) = std::tuple(b, c, a);
    else if (c.column < a.column)
        std::tie(a, b, c) = std::tuple(c, a, b);
    // From the leftmost corner to the rightmost one there is one edge; the third corner is below
    // it, or above.
    const bool is_below = b.column <= c.column;
    const Place middle = is_below ? b : c, right = is_below ? c : b;
    const Side across(*this, a, right);
    const auto scan = [&](const Side& side, std::uint32_t from, std::uint32_t to) {
        for (std::uint32_t column = from; column < to; ++column) {
            const Side &lower = is_below ? side : across, &upper = is_below ? across : side;
            if (!each_between(column, lower.first(column), upper.last(column), visit)) return false;
        }
        return true;
    };
    if (a.column < middle.column && !scan(Side(*this, a, middle), a.column, middle.column))
        return false;
    if (middle.column < right.column)
        return scan(Side(*this, middle, right), middle.column, right.column + 1);
    return each_between(right.column, std::min(middle.row, right.row),
                        std::max(middle.row, right.row), visit);
}

}  // namespace liftmesh::simplification
