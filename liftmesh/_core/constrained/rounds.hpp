// The order in which edges are put in that cross many triangles.
//
// Each crosses what those before have left behind, if they go from one end of the plane to the
// other. So chance decides, in rounds, each about twice as large as the one before (Amenta, Choi,
// Rote, "Incremental constructions con BRIO", 2003): in the order of their lines, blocks of edges
// are halved again and again, and of each block one is drawn. Once blocks are small, all that is in
// one is put in before the next, while what surrounds it is in the cache.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"

namespace liftmesh::constrained {

// Edges sorted by these numbers are near to those on almost the same line: by direction, in few
// sectors, then by distance from the middle, then by direction. Any number does.
class LineOrder {
 public:
    explicit LineOrder(const Bounds& box)
        : middle_{box.low[0] / 2 + box.high[0] / 2, box.low[1] / 2 + box.high[1] / 2},
          size_(2 * std::fmax(box.high[0] - middle_.x, box.high[1] - middle_.y)) {}

    std::uint64_t operator()(Point a, Point b) const {
        const bool is_turned = before_xy(b, a);
        const double x = is_turned ? a.x - b.x : b.x - a.x, y = is_turned ? a.y - b.y : b.y - a.y;
        const double slope = y / (x + std::fabs(y));
        const double across =
            ((a.x - middle_.x) * y - (a.y - middle_.y) * x) / (std::sqrt(x * x + y * y) * size_);
        return cell(slope, 63) << 48 | cell(across, 1 << 24) << 24 | cell(slope, (1 << 24) - 1);
    }

 private:
    // Of a number between -1 and 1.
    static std::uint64_t cell(double at, double cells) {
        const double part = (1 + at) / 2;
        return part > 0 ? static_cast<std::uint64_t>(std::fmin(part, 1) * (cells - 1)) : 0;
    }

    Point middle_;
    double size_;
};

class Rounds {
 public:
    explicit Rounds(std::size_t count)
        : count_(count), top_(std::max(static_cast<int>(std::bit_width(count)), in_cache)) {}

    // Calls visit(i) for each of the numbers below the count, while it returns true.
    template <class Visit>
    bool run(Visit visit) const {
        for (int level = top_; level >= in_cache; --level)
            if (!visit_blocks(0, level, top_ - level, visit)) return false;
        for (std::size_t part = 0; part << in_cache < count_; ++part)
            for (int level = in_cache - 1; level >= 0; --level)
                if (!visit_blocks(part, level, in_cache - level, visit)) return false;
        return true;
    }

 private:
    static constexpr int in_cache = 9;  // edges, by the power of two

    // Of the blocks of 2^level that are 2^depth parts of one: those drawn that were not drawn
    // before, for the block that a block is half of.
    template <class Visit>
    bool visit_blocks(std::size_t whole, int level, int depth, Visit visit) const {
        const std::size_t first = whole << depth, last = (whole + 1) << depth;
        for (std::size_t block = first; block < last && block << level < count_; ++block) {
            const std::size_t i = drawn(block, level);
            const bool is_old = level < top_ && drawn(block / 2, level + 1) == i;
            if (i < count_ && !is_old && !visit(i)) return false;
        }
        return true;
    }

    // Whichever is drawn is also drawn of the half that it is in.
    static std::size_t drawn(std::size_t block, int level) {
        for (; level > 0; --level)
            block = 2 * block + (hash(block + (std::uint64_t{1} << (level + 40))) >> 63);
        return block;
    }

    std::size_t count_;
    int top_;
};

}  // namespace liftmesh::constrained
