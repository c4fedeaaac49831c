// What is looked at, and why that is enough:
//
// - every triangle turns counter-clockwise;
// - the sides fall into pairs that run along one another in opposite directions, and a border;
// - the border is one closed curve that never turns inward and goes round once.
//
// Walk across the plane and count the triangles that lie over you. The number changes only where
// you cross a side, and crossing a pair of sides changes nothing: so it is the number of times that
// the border goes round you, which is 1 inside and 0 outside. Each triangle counts 1 and none less:
// so they cover the inside of a convex polygon, and no two overlap.
//
// - every row has a vertex at its position: so the polygon is the convex hull of the points;
// - across every inner edge, the apex of one triangle is not inside the circle of the other: so no
//   point is inside the circle of any triangle (Delaunay, 1934).
//
// The rule for ties is the same test after the lift of each point was moved by an infinitesimal of
// its own, so what passes it across every inner edge is the lower hull of the lifts that were
// moved, of which there is one: it is canonical.
//
// Where triangles turn clockwise or are flat none of this follows: then all sides are sorted, which
// names what is doubled, and circles are asked only across other sides, of triangles that have an
// inside. A list that turns clockwise as a whole is judged as if each triangle were named in the
// other order.
//
// Corners at one position may be several rows, as in meshes whose triangles share no vertices:
// where triangles do not hold together as they are, corners are named by the lowest row of their
// position instead.
//
// Nothing that decides is shared with the engines but the predicates with their guards, and the
// scaling, which is checked on the way back.

#include "verify/verify.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/scale.hpp"
#include "verify/border.hpp"
#include "verify/gather.hpp"
#include "verify/positions.hpp"
#include "verify/sides.hpp"

namespace liftmesh {

namespace {

// Rows that are not finite.
struct Skipped {
    std::size_t count = 0, first = 0;
};

// What the sides come to, by the names that corners have.
struct Finding {
    Sides sides;
    Flaws border;

    bool holds_together() const {
        return !sides.triangles.any() && !sides.border.empty() && !border.any();
    }
};

class Verification {
 public:
    Verification(const Input& input, const std::int32_t* simplices, std::size_t count,
                 ThreadPool& pool)
        : input_(input),
          simplices_(simplices),
          pool_(pool),
          points_(allocate<Point>(input.rows)),
          corners_(allocate<std::int32_t>(3 * count)),
          subject_{points_.get(), input.rows, corners_.get(), count, Guard::anywhere()},
          is_corner_(input.rows) {}

    Verdict run(bool skip_non_finite) {
        if (!read_points()) return interrupted();
        if (verdict_.skipped > 0 && !skip_non_finite) {
            verdict_.status = Status::non_finite;
            return std::move(verdict_);
        }
        return look() ? std::move(verdict_) : interrupted();
    }

 private:
    static Verdict interrupted() {
        Verdict verdict;
        verdict.status = Status::interrupted;
        return verdict;
    }

    bool look() {
        if (!read_corners()) return false;
        if (verdict_.flaws.any(Flaw::index)) return true;
        if (are_apart() && !merge_positions()) return false;
        if (!gather_triangles()) return false;
        Finding found;
        if (!look_at_triangles(found)) return false;
        if (verdict_.flaws.any(Flaw::non_finite)) return true;
        if (!look_at_sides(found)) return false;
        verdict_.flaws.add(found.sides.edges);
        verdict_.flaws.add(found.border);
        verdict_.inner = found.sides.inner;
        verdict_.border = found.sides.border.size();
        return count_vertices();
    }

    bool look_at_triangles(Finding& found) {
        if (!pass(found)) return false;
        verdict_.flaws.add(found.sides.triangles);
        return !all_turn_clockwise() || (turn_triangles() && pass(found));
    }

    // By the names that corners have, by position where that does not do, and where nothing does by
    // sorting, so that what is told depends on no order.
    bool look_at_sides(Finding& found) {
        if (!follow_border(found)) return false;
        if (!found.holds_together() && !merged_) {
            found = {};
            if (!merge_positions()) return false;
            if (verdict_.merged > 0 && !(pass(found) && follow_border(found))) return false;
        }
        if (found.holds_together()) return true;
        found = {};
        return sort_sides(subject_, pool_, found.sides) && follow_border(found);
    }

    bool pass(Finding& found) {
        found = {};
        return pass_triangles(subject_, pool_, found.sides);
    }

    bool follow_border(Finding& found) {
        return liftmesh::follow_border(subject_, found.sides.border, pool_, found.border);
    }

    // In blocks: work(first, last, task).
    template <class Work>
    bool in_blocks(std::size_t count, Work work) {
        return pool_.run(blocks(count), [&](std::size_t task) {
            work(task * block, std::min(count, (task + 1) * block), task);
        });
    }

    bool read_points() {
        std::vector<Range> ranges(blocks(input_.rows));
        std::vector<Skipped> skipped(ranges.size());
        const auto read = [&](std::size_t first, std::size_t last, std::size_t task) {
            pool_.interrupt().advance(last - first);
            for (std::size_t row = first; row < last; ++row) {
                const Point p = points_[row] = input_[row];
                if (is_finite(p)) {
                    ranges[task].add(p);
                } else if (skipped[task].count++ == 0) {
                    skipped[task].first = row;
                }
            }
        };
        if (!in_blocks(input_.rows, read)) return false;
        Range range;
        for (const Range& some : ranges) range.add(some);
        for (const Skipped& rows : skipped) {
            if (verdict_.skipped == 0) verdict_.row = rows.first;
            verdict_.skipped += rows.count;
        }
        const Scale scale(range);
        subject_.guard = scale.guard;
        return !scale.moves || move(scale);
    }

    // Believes no scale that the way back does not lead from.
    bool move(const Scale& scale) {
        std::atomic<bool> lossless = true;
        const bool done = in_blocks(input_.rows, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t row = first; row < last; ++row) {
                const Point p = points_[row];
                const Point moved = points_[row] = scale(p);
                const Point back{moved.x / scale.second / scale.first,
                                 moved.y / scale.second / scale.first};
                if (is_finite(p) && !(back == p)) lossless = false;
            }
        });
        if (!lossless) throw std::logic_error("points that were scaled are not the same points");
        return done;
    }

    // From here on corners are our own: no one can change them meanwhile.
    bool read_corners() {
        std::vector<Flaws> found(blocks(subject_.count));
        const auto read = [&](std::size_t first, std::size_t last, std::size_t task) {
            for (std::size_t place = 3 * first; place < 3 * last; ++place) {
                corners_[place] = simplices_[place];
                if (const Row row = subject_.corner(place); row < subject_.rows) {
                    mark(is_corner_[row]);
                } else {
                    found[task].add(Flaw::index, {place, 0});
                }
            }
        };
        const bool done = in_blocks(subject_.count, read);
        for (const Flaws& some : found) verdict_.flaws.add(some);
        return done;
    }

    // Several threads may meet here. Most marks are there already.
    static void mark(std::uint8_t& byte) {
        const std::atomic_ref<std::uint8_t> shared(byte);
        if (shared.load(std::memory_order_relaxed) == 0) shared.store(1, std::memory_order_relaxed);
    }

    // Triangles that hold together, without a hole, have at most two more corners than they are: as
    // they are named, these do not.
    bool are_apart() const {
        const auto corners = std::count(is_corner_.begin(), is_corner_.end(), 1);
        return static_cast<std::size_t>(corners) > subject_.count + 2;
    }

    bool gather_triangles() {
        Gathered gathered;
        if (!gather(subject_, pool_, gathered)) return false;
        if (gathered.order == nullptr) return true;
        corners_ = std::move(gathered.simplices);
        order_ = std::move(gathered.order);
        subject_.simplices = corners_.get();
        subject_.order = order_.get();
        return true;
    }

    // A whole mesh that was made to be seen from below is one mistake: what else is wrong is looked
    // for after it was put right.
    bool all_turn_clockwise() const {
        const std::size_t turned = verdict_.flaws[Flaw::clockwise].count();
        return turned > 0 && turned + verdict_.flaws[Flaw::flat].count() == subject_.count;
    }

    bool turn_triangles() {
        subject_.turned = true;
        return in_blocks(subject_.count, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t t = first; t < last; ++t)
                std::swap(corners_[3 * t + 1], corners_[3 * t + 2]);
        });
    }

    // Names each corner by the lowest row of its position.
    bool merge_positions() {
        merged_ = true;
        std::vector<Row> lowest;
        if (!find_lowest(subject_, pool_, lowest)) return false;
        Marks kept(subject_.rows);
        for (std::size_t row = 0; row < subject_.rows; ++row)
            if (is_corner_[row]) verdict_.merged += std::exchange(kept[lowest[row]], 1);
        if (verdict_.merged == 0) return true;
        is_corner_ = std::move(kept);
        return in_blocks(subject_.count, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t place = 3 * first; place < 3 * last; ++place)
                corners_[place] = static_cast<std::int32_t>(lowest[subject_.corner(place)]);
        });
    }

    bool count_vertices() {
        for (const std::uint8_t corner : is_corner_) verdict_.vertices += corner;
        return verdict_.vertices + verdict_.merged + verdict_.skipped == subject_.rows ||
               find_missing(subject_, is_corner_, pool_, verdict_.flaws);
    }

    const Input& input_;
    const std::int32_t* simplices_;
    ThreadPool& pool_;
    Buffer<Point> points_;
    Buffer<std::int32_t> corners_;
    Buffer<std::uint32_t> order_;
    Subject subject_;
    Marks is_corner_;
    bool merged_ = false;  // corners are named by the lowest row of their position
    Verdict verdict_;
};

}  // namespace

Verdict verify(const Input& input, const std::int32_t* simplices, std::size_t count,
               bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(std::max(input.rows, count)), interrupt);
    interrupt.expect(input.rows + 3 * count);
    return Verification(input, simplices, count, pool).run(skip_non_finite);
}

}  // namespace liftmesh
