// Where the points of a node are alone, and which triangles no other point of the input can change.
//
// A triangle is settled if its closed circumdisk certainly holds no point of another tile. The disk
// is computed in floating point and rounded outwards: a wrong "no" costs time, a wrong "yes" cannot
// happen.
//
// The bounds, with e = 2^-53. Let L be the greatest of |dx|, |dy|, |ex|, |ey|, the differences of
// the corners b and c from a. They are multiplied by a power of two unless L is in [2^-140, 2^200];
// then L is in [2^-52, 8). Differences are within e of the exact ones, relatively, and products of
// two or three of them within 3 e and 6 e. What underflows, in a product or in a scaled difference,
// is less than 2^-870, and counted as `tiny`: four hundred binary orders below e L^2. So
//
//   det = 2 (dx ey - dy ex) is within 16 e (|dx ey| + |dy ex|) + tiny,
//   nx = ey |d|^2 - dy |e|^2 within 16 e (|ey| |d|^2 + |dy| |e|^2) + tiny, and ny likewise;
//
// half of either factor would do. The centre is (nx, ny) / det from a. Where det exceeds its bound,
// by `rest`, a quotient nx / det is within (error of nx + |nx / det| (error of det)) / rest + 2 e
// |nx / det|, which is summed over both. The radius is the length of the computed vector, plus that
// sum. Rounding the centre to a + u / s, and all to multiples of 2^-1074 where they are that small,
// is `slack`. An overflow makes the radius infinite or NaN, and nothing is settled.
//
// Comparisons round once: a rounded difference exceeds a double only if the exact one does. The
// distance to a box is lowered by its error, and scaled before it is squared: squares do not
// underflow there, because the radius is at least L / 2.
//
// Most disks are far from the sides of the cell, which takes no division to find. The diameter is
// |d| |e| |f| / |det / 2|, with f from b to c, and the disk is within a diameter of a. Where the
// computed |d|^2 |e|^2 |f|^2 is in [2^-500, 2^500], and none of the three exceeds 2^200, none is
// less than 2^-900: nothing has underflowed, and their product is within 32 e. With at most 2^200
// of space, det / 2 is greater than 2^-450 if the disk is found near: nothing underflows there that
// counts, and its error is at most the bound from above.
#pragma once

#include "base/input.hpp"
#include "base/point.hpp"

namespace liftmesh {

// A point of a tiled input and its row in the whole of it, as tiles and frontiers store them.

using RowId = std::int64_t;  // the rows of all tiles together may exceed 32 bits

struct Record {
    RowId id;
    Point point;
};

static_assert(sizeof(Record) == 24, "files hold records");

// Their points, read in place.
inline Input points_of(std::span<const Record> records) {
    const auto* first = reinterpret_cast<const std::byte*>(records.data());
    return {first + sizeof(RowId), records.size(), sizeof(Record), sizeof(double), false};
}

struct Box {
    Point low, high;
};

// Whether the circumdisk is certainly within `space` of a; "no" says nothing.
inline bool is_near(Point a, Point b, Point c, double space) {
    const double dx = b.x - a.x, dy = b.y - a.y, ex = c.x - a.x, ey = c.y - a.y;
    const double fx = c.x - b.x, fy = c.y - b.y;
    const double d = dx * dx + dy * dy, e = ex * ex + ey * ey, f = fx * fx + fy * fy;
    const double p = dx * ey, q = dy * ex;
    const double rest = std::fabs(p - q) - 0x1p-49 * (std::fabs(p) + std::fabs(q));
    const double product = d * e * f, across = rest * space;
    return rest > 0 && space > 0 && product * (1 + 0x1p-40) < across * across &&
           product > 0x1p-500 && product < 0x1p500 && std::max({d, e, f}) < 0x1p200;
}

class Disk {
 public:
    Disk(Point a, Point b, Point c) {
        double dx = b.x - a.x, dy = b.y - a.y, ex = c.x - a.x, ey = c.y - a.y;
        const double size = std::max({std::fabs(dx), std::fabs(dy), std::fabs(ex), std::fabs(ey)});
        if (!(size >= 0x1p-140 && size <= 0x1p200)) {
            if (!(size > 0 && size <= std::numeric_limits<double>::max())) return;
            scale_ = std::ldexp(1.0, std::clamp(-std::ilogb(size), -1022, 1022));
            dx *= scale_, dy *= scale_, ex *= scale_, ey *= scale_;
        }
        const double d = dx * dx + dy * dy, e = ex * ex + ey * ey;
        const double p = dx * ey, q = dy * ex, det = 2 * (p - q);
        const double det_error = bound * (std::fabs(p) + std::fabs(q)) + tiny;
        const double rest = std::fabs(det) - det_error;
        if (!(rest > 0)) return;
        const double ux = (ey * d - dy * e) / det, uy = (dx * e - ex * d) / det;
        const double sum = std::fabs(ux) + std::fabs(uy);
        const double n_error =
            bound * ((std::fabs(ey) + std::fabs(ex)) * d + (std::fabs(dy) + std::fabs(dx)) * e) +
            2 * tiny;
        const double error = (n_error + sum * det_error) / rest + bound * sum;
        radius_ = std::sqrt(ux * ux + uy * uy) * above + error;
        const double back = 1 / scale_;
        center_ = {a.x + ux * back, a.y + uy * back};
        slack_ =
            error * back + 0x1p-50 * (std::fabs(a.x) + std::fabs(a.y) + radius_ * back) + 0x1p-1071;
        reach_ = radius_ * back + slack_;
    }

    bool is_known() const { return reach_ < std::numeric_limits<double>::infinity(); }

    bool is_inside(const Box& cell) const {
        return center_.x - reach_ > cell.low.x && center_.x + reach_ < cell.high.x &&
               center_.y - reach_ > cell.low.y && center_.y + reach_ < cell.high.y;
    }

    // A box that holds it.
    Box bounds() const {
        constexpr double far = std::numeric_limits<double>::infinity();
        if (!is_known()) return {{-far, -far}, {far, far}};
        return {{center_.x - reach_, center_.y - reach_}, {center_.x + reach_, center_.y + reach_}};
    }

    // Of a known disk.
    bool is_clear_of(const Box& box) const {
        const double x = gap(box.low.x - center_.x, center_.x - box.high.x);
        const double y = gap(box.low.y - center_.y, center_.y - box.high.y);
        return (x * x + y * y) * below > radius_ * radius_ * above;
    }

 private:
    static constexpr double bound = 0x1p-49;  // 16 e
    static constexpr double above = 1 + 0x1p-50, below = 1 - 0x1p-50;
    static constexpr double tiny = 0x1p-800;

    double gap(double before, double after) const {
        return std::max((std::max(before, after) * below - slack_) * scale_, 0.0);
    }

    Point center_ = {};
    double scale_ = 1;
    double radius_ = 0;  // scaled
    double slack_ = 0;   // not scaled, as the centre
    double reach_ = std::numeric_limits<double>::infinity();
};

struct Territory {
    Box cell;                      // in its interior all points of the input are the node's
    std::span<const Box> foreign;  // these hold all points of other nodes
    bool is_everything;            // there are none: the node is the root

    // `last` remembers which box was in the way: mostly it is in the way of the next one, too.
    bool settles(Point a, Point b, Point c, std::size_t& last) const {
        const double beside = std::min(a.x - cell.low.x, cell.high.x - a.x);
        const double above = std::min(a.y - cell.low.y, cell.high.y - a.y);
        if (is_near(a, b, c, std::min({beside, above, 0x1p200}))) return true;
        const Disk disk(a, b, c);
        if (!disk.is_known()) return false;
        if (disk.is_inside(cell)) return true;
        if (last < foreign.size() && !disk.is_clear_of(foreign[last])) return false;
        const auto in_the_way = std::find_if(
            foreign.begin(), foreign.end(), [&](const Box& box) { return !disk.is_clear_of(box); });
        last = static_cast<std::size_t>(in_the_way - foreign.begin());
        return in_the_way == foreign.end();
    }
};

}  // namespace liftmesh
