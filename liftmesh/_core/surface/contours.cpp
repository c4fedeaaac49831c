#include "surface/contours.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>

#include "base/floating_point.hpp"
#include "surface/crossed.hpp"
#include "surface/places.hpp"

namespace liftmesh {

namespace {

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
