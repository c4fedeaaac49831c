#include "surface/contours.hpp"

#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "parallel/thread_pool.hpp"
#include "surface/facet.hpp"
#include "surface/lists.hpp"
#include "surface/relief.hpp"

namespace liftmesh {

namespace {

// The places of faces in an ascending list of some of them: a bit for each face that is in it, and
// for each 64 faces the place of the first. The bits of one list are taken back in as many steps as
// it has faces.

class Places {
 public:
    explicit Places(std::size_t faces) : words_(faces / 64 + 1) {}

    // Of ascending faces, one after the other.
    void add(std::int32_t face, std::int32_t place) {
        Word& word = words_[number(face)];
        if (word.bits == 0) word.first = place;
        word.bits |= bit(face);
    }
    // The word of a face that was added, and so all faces in it.
    void remove(std::int32_t face) { words_[number(face)].bits = 0; }

    // The place of a face, or -1.
    std::int32_t find(std::int32_t face) const {
        if (face < 0) return -1;
        const Word& word = words_[number(face)];
        const std::uint64_t mine = bit(face);
        return (word.bits & mine) == 0 ? -1 : word.first + std::popcount(word.bits & (mine - 1));
    }

 private:
    struct Word {
        std::uint64_t bits = 0;
        std::int32_t first = 0;
    };
    static std::size_t number(std::int32_t face) { return static_cast<std::size_t>(face) / 64; }
    static std::uint64_t bit(std::int32_t face) { return std::uint64_t{1} << (face % 64); }

    std::vector<Word> words_;
};

// The faces that levels cross, level by level.
//
// A corner is above a level if its height is at least the level. What decides this is read once:
// the rank of a row is the number of levels that are not above its height, so a corner is above the
// levels below its rank, and a face is crossed by those from the least of its ranks to the
// greatest. Ranks take a sixth of the memory of rows, and all that follows agrees with them, even
// if rows are written meanwhile.

// Through one face, with what is above on the left.
struct CrossedStep {
    Point exit;         // on the side by which the line leaves the face
    std::int32_t face;  // -1 if it is none
    std::int32_t next;  // across that side; -1 if there is none
};

class Crossed {
 public:
    // Levels ascend.
    Crossed(const Relief& relief, const double* levels, std::size_t count, ThreadPool& pool);

    // False if the interrupt came first.
    bool list();

    // By ascending faces.
    const CrossedStep* begin(std::size_t level) const { return steps_.begin(level); }
    const CrossedStep* end(std::size_t level) const { return steps_.end(level); }

    // The point by which the line of a level enters a face.
    Point entry(std::size_t level, std::int32_t face) const;

 private:
    struct Ranks {
        std::uint32_t of[3];  // of the corners of a face
    };
    bool rank();
    template <class Visit>
    bool for_each(Visit visit);
    Ranks ranks(std::int32_t face) const;
    Point crossing_on(std::int32_t face, int side, std::size_t level) const;

    const Relief& relief_;
    const double* levels_;
    std::size_t count_;
    ThreadPool& pool_;
    Buffer<std::uint32_t> rank_;  // of each row
    Lists<CrossedStep> steps_;
};

constexpr std::size_t rows_together = std::size_t{1} << 15;
constexpr std::size_t levels_block = std::size_t{1} << 14, most_level_blocks = 256;
constexpr std::size_t most_lists = std::size_t{1} << 20;  // unless there are more levels

std::size_t blocks_of(std::size_t faces, std::size_t levels) {
    const std::size_t most =
        std::clamp<std::size_t>(most_lists / (levels + 1), 1, most_level_blocks);
    return std::clamp<std::size_t>(faces / levels_block, 1, most);
}

// How many levels are not above a height, without a branch that depends on it.
std::uint32_t rank_of(double height, const double* levels, std::size_t count) {
    std::size_t first = 0;
    for (std::size_t size = count; size > 0;) {
        const std::size_t half = (size + 1) / 2;
        first += levels[first + half - 1] <= height ? half : 0;
        size -= half;
    }
    return static_cast<std::uint32_t>(first);
}

// The sides by which a line enters a face and leaves it, by the corners opposite, for each set of
// corners that are above: heights fall along the first, counter-clockwise, and rise along the
// second.
constexpr std::int8_t entry_side[8] = {0, 2, 0, 0, 1, 2, 1, 0};
constexpr std::int8_t exit_side[8] = {0, 1, 2, 1, 0, 0, 2, 0};

std::size_t corners_above(const std::uint32_t* ranks, std::size_t level) {
    return std::size_t{ranks[0] > level} | std::size_t{ranks[1] > level} << 1 |
           std::size_t{ranks[2] > level} << 2;
}

Crossed::Crossed(const Relief& relief, const double* levels, std::size_t count, ThreadPool& pool)
    : relief_(relief),
      levels_(levels),
      count_(count),
      pool_(pool),
      rank_(allocate<std::uint32_t>(relief.mesh().points.rows)),
      steps_(count, blocks_of(relief.mesh().count, count)) {}

bool Crossed::list() {
    const auto count = [this](std::size_t block, std::size_t level, std::int32_t, const Ranks&) {
        steps_.count(level, block);
    };
    if (!rank() || !for_each(count)) return false;
    steps_.make_room();
    const auto put = [this](std::size_t block, std::size_t level, std::int32_t face,
                            const Ranks& ranks) {
        const int side = exit_side[corners_above(ranks.of, level)];
        steps_.put(level, block,
                   {crossing_on(face, side, level), face, relief_.mesh().neighbor(face, side)});
    };
    const bool done = for_each(put);
    steps_.close({{}, -1, -1});
    return done;
}

bool Crossed::rank() {
    const std::size_t rows = relief_.mesh().points.rows;
    return in_blocks(
        rows, rows_together, pool_, [this](std::size_t row, std::size_t last, std::size_t) {
            for (; row < last; ++row)
                rank_[row] =
                    rank_of(relief_.height_of(static_cast<std::int32_t>(row)), levels_, count_);
        });
}

Crossed::Ranks Crossed::ranks(std::int32_t face) const {
    Ranks found;
    for (int k = 0; k < 3; ++k)
        found.of[k] = rank_[static_cast<std::size_t>(relief_.mesh().vertex(face, k))];
    return found;
}

// visit(block, level, face, ranks) wherever a level crosses a face.
template <class Visit>
bool Crossed::for_each(Visit visit) {
    const std::size_t faces = relief_.mesh().count, blocks = steps_.blocks();
    const bool done = pool_.run(blocks, [&, faces, blocks](std::size_t block) {
        Patience patience(pool_.interrupt());
        const auto last = static_cast<std::int32_t>(faces * (block + 1) / blocks);
        for (auto face = static_cast<std::int32_t>(faces * block / blocks); face < last; ++face) {
            const Ranks found = ranks(face);
            const auto [low, high] = std::minmax({found.of[0], found.of[1], found.of[2]});
            if (patience.ends(1 + high - low)) return;
            if (low == high || !relief_.is_shown(face)) continue;
            for (std::size_t level = low; level < high; ++level) visit(block, level, face, found);
        }
    });
    return done && !pool_.interrupt().requested();
}

Point Crossed::entry(std::size_t level, std::int32_t face) const {
    return crossing_on(face, entry_side[corners_above(ranks(face).of, level)], level);
}

Point Crossed::crossing_on(std::int32_t face, int side, std::size_t level) const {
    return crossing(relief_.corner(face, (side + 1) % 3), relief_.corner(face, (side + 2) % 3),
                    levels_[level]);
}

struct Line {
    std::size_t first, last;  // points
    bool is_closed;
};

// The lines of one level, in their order.
struct Lines {
    Buffer<Point> points;
    std::vector<Line> lines;

    std::size_t count() const { return lines.empty() ? 0 : lines.back().last; }
};

// Traces the lines of one level after another.
class Tracer {
 public:
    Tracer(const Crossed& crossed, std::size_t faces, Interrupt& interrupt)
        : crossed_(crossed), places_(faces), patience_(interrupt) {}

    Lines run(std::size_t level) {
        level_ = level;
        steps_ = crossed_.begin(level);
        count_ = static_cast<std::size_t>(crossed_.end(level) - steps_);
        points_.clear();
        lines_.clear();
        link();
        for (std::size_t i = 0; i < count_ && !patience_.ends(); ++i)
            if (before_[i] < 0 && steps_[i].face >= 0) trace_open(i);
        for (std::size_t i = 0; i < count_ && !patience_.ends(); ++i)
            if (!is_done_[i] && steps_[i].face >= 0) trace_closed(i);
        return sorted();
    }

 private:
    // Finds the step that follows each. A place may be wrong if steps are none.
    void link() {
        for (std::size_t i = 0; i < count_; ++i)
            if (steps_[i].face >= 0) places_.add(steps_[i].face, static_cast<std::int32_t>(i));
        is_done_.assign(count_, 0);
        before_.assign(count_, -1);
        next_.resize(count_);
        for (std::size_t i = 0; i < count_; ++i) {
            const std::int32_t next = places_.find(steps_[i].next);
            next_[i] = next >= 0 && step(next).face == steps_[i].next ? next : -1;
            if (next_[i] >= 0)
                before_[static_cast<std::size_t>(next)] = static_cast<std::int32_t>(i);
        }
        for (std::size_t i = 0; i < count_; ++i)
            if (steps_[i].face >= 0) places_.remove(steps_[i].face);
    }
    const CrossedStep& step(std::int32_t place) const {
        return steps_[static_cast<std::size_t>(place)];
    }

    void trace_open(std::size_t first) {
        const std::size_t start = points_.size();
        add(start, crossed_.entry(level_, steps_[first].face));
        follow(start, first);
        finish({start, points_.size(), false});
    }

    void trace_closed(std::size_t first) {
        const std::size_t start = points_.size();
        add(start, step(before_[first]).exit);
        follow(start, first);
        finish({start, points_.size(), true});
    }

    void follow(std::size_t start, std::size_t at) {
        while (!is_done_[at] && !patience_.ends()) {
            is_done_[at] = 1;
            add(start, steps_[at].exit);
            if (next_[at] < 0) return;
            at = static_cast<std::size_t>(next_[at]);
        }
    }

    // The line begins at `start`.
    void add(std::size_t start, Point at) {
        if (at.x != at.x || at.y != at.y) return;  // rows were written meanwhile
        if (points_.size() == start || !(points_.back() == at)) points_.push_back(at);
    }

    void finish(const Line& line) {
        if (line.last < line.first + 2) return points_.resize(line.first);
        if (line.is_closed) begin_at_least(&points_[line.first], line.last - line.first - 1);
        lines_.push_back(line);
    }

    // Of a closed line, whose first point comes again after the last one. Of several visits to the
    // least point, the one with the least successor comes first.
    static void begin_at_least(Point* points, std::size_t count) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < count; ++i)
            if (before_xy(points[i], points[best]) ||
                (points[i] == points[best] && before_xy(points[i + 1], points[best + 1])))
                best = i;
        std::rotate(points, points + best, points + count);
        points[count] = points[0];
    }

    Lines sorted() {
        std::sort(lines_.begin(), lines_.end(),
                  [this](const Line& p, const Line& q) { return is_before(p, q); });
        Lines found{allocate<Point>(points_.size()), {}};
        found.lines.reserve(lines_.size());
        for (const Line& line : lines_) {
            const std::size_t start = found.count();
            std::copy(&points_[line.first], &points_[0] + line.last, &found.points[start]);
            found.lines.push_back({start, start + line.last - line.first, line.is_closed});
        }
        return found;
    }
    bool is_before(const Line& p, const Line& q) const {
        const Point* const all = points_.data();
        return std::lexicographical_compare(all + p.first, all + p.last, all + q.first,
                                            all + q.last, before_xy);
    }

    const Crossed& crossed_;
    Places places_;
    Patience patience_;
    std::size_t level_ = 0, count_ = 0;
    const CrossedStep* steps_ = nullptr;
    std::vector<std::int32_t> next_, before_;  // steps, or -1
    std::vector<std::uint8_t> is_done_;
    std::vector<Point> points_;
    std::vector<Line> lines_;
};

// The lines of all levels; threads share the levels. False if the interrupt came first.
bool trace(const Relief& relief, const double* levels, std::vector<Lines>& found,
           ThreadPool& pool) {
    Crossed crossed(relief, levels, found.size(), pool);
    if (!crossed.list()) return false;
    std::atomic<std::size_t> next = 0;
    return pool.run(std::min<std::size_t>(found.size(), pool.size()), [&](std::size_t) {
        Tracer tracer(crossed, relief.mesh().count, pool.interrupt());
        for (std::size_t level; (level = next.fetch_add(1)) < found.size();) {
            if (pool.interrupt().requested()) return;
            found[level] = tracer.run(level);
        }
    });
}

// One level after the other.
bool join(std::vector<Lines>& lines, Contours& found, ThreadPool& pool) {
    std::vector<std::size_t> first(lines.size() + 1);
    found.starts = {0};
    for (std::size_t level = 0; level < lines.size(); ++level) {
        for (const Line& line : lines[level].lines) {
            found.starts.push_back(static_cast<std::int64_t>(first[level] + line.last));
            found.levels.push_back(static_cast<std::int32_t>(level));
            found.is_closed.push_back(line.is_closed);
        }
        first[level + 1] = first[level] + lines[level].count();
    }
    found.points = allocate<Point>(first.back());
    return pool.run(lines.size(), [&](std::size_t level) {
        const Lines some = std::move(lines[level]);
        std::copy_n(some.points.get(), some.count(), &found.points[first[level]]);
    });
}

}  // namespace

bool contours(const Relief& relief, const double* levels, std::size_t count, Contours& found,
              Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(relief.mesh().count), interrupt);
    std::vector<Lines> lines(count);
    return trace(relief, levels, lines, pool) && join(lines, found, pool) &&
           !pool.interrupt().requested();
}

}  // namespace liftmesh
