#include "surface/contours.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "surface/crossing.hpp"
#include "surface/lists.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t block_size = std::size_t{1} << 14, most_blocks = 256;
constexpr std::size_t most_lists = std::size_t{1} << 20;  // unless there are more levels

struct Line {
    std::vector<Point> points;
    bool is_closed;
};

bool before(const Line& p, const Line& q) {
    return std::lexicographical_compare(p.points.begin(), p.points.end(), q.points.begin(),
                                        q.points.end(), before_xy);
}

// The faces that each level crosses.
class Crossed {
 public:
    Crossed(const Relief& relief, const double* levels, std::size_t count, ThreadPool& pool)
        : relief_(relief),
          levels_(levels),
          count_(count),
          pool_(pool),
          lists_(count, std::clamp<std::size_t>(
                            relief.mesh().count / block_size, 1,
                            std::clamp<std::size_t>(most_lists / (count + 1), 1, most_blocks))) {}

    bool list() {
        if (!for_each([this](std::size_t block, std::size_t level, std::int32_t) {
                lists_.count(level, block);
            }))
            return false;
        lists_.make_room();
        const bool done = for_each([this](std::size_t block, std::size_t level, std::int32_t face) {
            lists_.put(level, block, face);
        });
        lists_.close();
        return done;
    }

    // Faces, or -1.
    const std::int32_t* begin(std::size_t level) const { return lists_.begin(level); }
    const std::int32_t* end(std::size_t level) const { return lists_.end(level); }

 private:
    // visit(block, level, face) wherever a level crosses a face.
    template <class Visit>
    bool for_each(Visit visit) {
        const std::size_t faces = relief_.mesh().count, blocks = lists_.blocks();
        const bool done = pool_.run(blocks, [&, faces, blocks](std::size_t block) {
            Patience patience(pool_.interrupt());
            const auto last = static_cast<std::int32_t>(faces * (block + 1) / blocks);
            for (auto face = static_cast<std::int32_t>(faces * block / blocks); face < last;
                 ++face) {
                if (!relief_.is_shown(face)) continue;
                const auto [first, end] = levels_of(face);
                if (patience.ends(1 + end - first)) return;
                for (std::size_t level = first; level < end; ++level) visit(block, level, face);
            }
        });
        return done && !pool_.interrupt().requested();
    }

    // The levels above the lowest corner and not above the highest.
    std::pair<std::size_t, std::size_t> levels_of(std::int32_t face) const {
        const double a = height(face, 0), b = height(face, 1), c = height(face, 2);
        const double low = std::min(std::min(a, b), c), high = std::max(std::max(a, b), c);
        std::size_t first = 0;
        for (std::size_t size = count_; size > 0;) {  // without a branch that depends on heights
            const std::size_t half = (size + 1) / 2;
            first += levels_[first + half - 1] <= low ? half : 0;
            size = size - half;
        }
        std::size_t last = first;
        while (last < count_ && levels_[last] <= high) ++last;
        return {first, last};
    }
    double height(std::int32_t face, int k) const {
        return relief_.height_of(relief_.mesh().vertex(face, k));
    }

    const Relief& relief_;
    const double* levels_;
    std::size_t count_;
    ThreadPool& pool_;
    FaceLists lists_;
};

// The lines of one level.
class Tracer {
 public:
    Tracer(const Relief& relief, double level, std::vector<bool>& is_done, Patience& patience)
        : relief_(relief), level_(level), is_done_(is_done), patience_(patience) {}

    std::vector<Line> run(const std::int32_t* first, const std::int32_t* last) {
        for (const std::int32_t* face = first; face != last && !patience_.ends(); ++face)
            if (*face >= 0 && !is_done(*face)) trace(*face);
        for (const std::int32_t* face = first; face != last; ++face)
            if (*face >= 0) is_done(*face) = false;
        std::sort(lines_.begin(), lines_.end(), before);
        return std::move(lines_);
    }

 private:
    std::vector<bool>::reference is_done(std::int32_t face) {
        return is_done_[static_cast<std::size_t>(face)];
    }

    // The sides, by the corners opposite, by which the line enters a face and leaves it. One corner
    // is alone on its side of the level.
    struct Passage {
        int entry, exit;
    };
    Passage passage(std::int32_t face) const {
        bool above[3];
        for (int k = 0; k < 3; ++k)
            above[k] = relief_.height_of(relief_.mesh().vertex(face, k)) >= level_;
        const int k = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
        const int following = (k + 1) % 3, last = (k + 2) % 3;
        return above[k] ? Passage{last, following} : Passage{following, last};
    }

    // Forward until it closes or ends, and in that case backward from where it began.
    void trace(std::int32_t face) {
        Line line{{}, false};
        const int entry = passage(face).entry;
        add(line, face, entry);
        std::int32_t at = face;
        while (relief_.is_shown(at) && !is_done(at) && !patience_.ends()) {
            is_done(at) = true;
            const int side = passage(at).exit;
            add(line, at, side);
            at = relief_.mesh().neighbor(at, side);
        }
        line.is_closed = at == face;
        if (!line.is_closed) {
            std::reverse(line.points.begin(), line.points.end());
            extend_back(line, relief_.mesh().neighbor(face, entry));
            std::reverse(line.points.begin(), line.points.end());
        }
        if (line.points.size() < 2) return;
        if (line.is_closed) begin_at_least(line.points);
        lines_.push_back(std::move(line));
    }

    void extend_back(Line& line, std::int32_t at) {
        while (relief_.is_shown(at) && !is_done(at) && !patience_.ends()) {
            is_done(at) = true;
            const int side = passage(at).entry;
            add(line, at, side);
            at = relief_.mesh().neighbor(at, side);
        }
    }

    void add(Line& line, std::int32_t face, int side) const {
        const Point at = crossing(relief_.corner(face, (side + 1) % 3),
                                  relief_.corner(face, (side + 2) % 3), level_);
        if (at.x != at.x || at.y != at.y) return;  // rows were written meanwhile
        if (line.points.empty() || !(line.points.back() == at)) line.points.push_back(at);
    }

    // Of several visits to the least point, the one with the least successor comes first.
    static void begin_at_least(std::vector<Point>& points) {
        points.pop_back();  // the first, again
        const std::size_t count = points.size();
        std::size_t best = 0;
        for (std::size_t i = 1; i < count; ++i) {
            const Point next = points[(i + 1) % count], best_next = points[(best + 1) % count];
            if (before_xy(points[i], points[best]) ||
                (points[i] == points[best] && before_xy(next, best_next)))
                best = i;
        }
        std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(best),
                    points.end());
        points.push_back(points.front());
    }

    const Relief& relief_;
    double level_;
    std::vector<bool>& is_done_;
    Patience& patience_;
    std::vector<Line> lines_;
};

void append(Contours& found, const std::vector<Line>& lines, std::size_t level) {
    for (const Line& line : lines) {
        found.points.insert(found.points.end(), line.points.begin(), line.points.end());
        found.starts.push_back(static_cast<std::int64_t>(found.points.size()));
        found.levels.push_back(static_cast<std::int32_t>(level));
        found.is_closed.push_back(line.is_closed);
    }
}

}  // namespace

bool contours(const Relief& relief, const double* levels, std::size_t count, Contours& found,
              Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    found.starts = {0};
    ThreadPool pool(threads.for_rows(relief.mesh().count), interrupt);
    Crossed crossed(relief, levels, count, pool);
    if (!crossed.list()) return false;
    const std::size_t shares = std::min<std::size_t>(count, pool.size());
    std::vector<std::vector<Line>> lines(count);
    const bool done = pool.run(shares, [&](std::size_t share) {
        Patience patience(pool.interrupt());
        std::vector<bool> is_done(relief.mesh().count);
        for (std::size_t level = share; level < count && !patience.ends(); level += shares)
            lines[level] = Tracer(relief, levels[level], is_done, patience)
                               .run(crossed.begin(level), crossed.end(level));
    });
    if (!done || pool.interrupt().requested()) return false;
    for (std::size_t level = 0; level < count; ++level) {
        append(found, lines[level], level);
        lines[level] = {};
        if (interrupt.requested()) return false;
    }
    return true;
}

}  // namespace liftmesh
