#include "verify/border.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/buffer.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

class Border {
 public:
    Border(const Subject& subject, const std::vector<Side>& border, ThreadPool& pool)
        : subject_(subject), border_(border), pool_(pool), next_(allocate<Row>(subject.rows)) {}

    bool look(Flaws& flaws) {
        link(flaws);
        if (flaws.any(Flaw::pinched) || border_.empty()) return true;
        Flaws turns;
        std::size_t rounds = 0;
        if (!look_at_turns(turns, rounds)) return false;
        if (rounds == 1 && !turns.any()) return true;
        if (find_pieces(flaws)) return true;
        flaws.add(turns);
        if (!turns.any()) flaws.add(Flaw::winding, {border_.front().tail, rounds});
        return true;
    }

 private:
    void link(Flaws& flaws) {
        std::fill_n(next_.get(), subject_.rows, nowhere);
        std::vector<Row> again;
        for (const Side& side : border_)
            if (std::exchange(next_[side.tail], side.head) != nowhere) again.push_back(side.tail);
        std::sort(again.begin(), again.end());
        again.erase(std::unique(again.begin(), again.end()), again.end());
        for (const Row row : again) flaws.add(Flaw::pinched, {row, 0});
    }

    // A curve that only turns left has one row in each round that comes before both its neighbours
    // in the order by x, then y. So has each of several curves: one such row in all is one curve.
    bool look_at_turns(Flaws& flaws, std::size_t& rounds) const {
        std::vector<Flaws> found(blocks(border_.size()));
        std::vector<std::size_t> least(found.size());
        const bool done = pool_.run(found.size(), [&](std::size_t task) {
            const std::size_t last = std::min(border_.size(), (task + 1) * block);
            for (std::size_t i = task * block; i < last; ++i) {
                __builtin_prefetch(&next_[border_[std::min(i + 2 * ahead, last - 1)].head]);
                fetch(border_[std::min(i + ahead, last - 1)]);
                least[task] += turn(border_[i], found[task]);
            }
        });
        for (const Flaws& some : found) flaws.add(some);
        rounds = std::accumulate(least.begin(), least.end(), std::size_t{0});
        return done;
    }

    void fetch(const Side& side) const {
        for (const Row row : {side.tail, side.head, next_[side.head]})
            __builtin_prefetch(&subject_.points[row]);
    }

    // Looks at the turn of the curve at the head of a side. Whether that is a least row.
    bool turn(const Side& side, Flaws& flaws) const {
        const Row after = next_[side.head];
        const Point a = subject_.points[side.tail], b = subject_.points[side.head];
        const Point c = subject_.points[after];
        const int sign = orient2d(a, b, c);
        if (sign < 0 || (sign == 0 && !goes_on(a, b, c)))
            flaws.add(Flaw::hull, {side.head, std::uint64_t{side.tail} << 32 | after});
        return before_xy(b, a) && before_xy(b, c);
    }

    // Along a line, rather than back or nowhere.
    static bool goes_on(Point a, Point b, Point c) {
        return (before_xy(a, b) && before_xy(b, c)) || (before_xy(c, b) && before_xy(b, a));
    }

    // Follows the border. Where it is several curves, they are what is wrong.
    bool find_pieces(Flaws& flaws) {
        std::vector<Row> starts;
        for (const Side& side : border_) {
            if (next_[side.tail] == nowhere) continue;
            starts.push_back(side.tail);
            for (Row at = side.tail; at != nowhere;) at = std::exchange(next_[at], nowhere);
        }
        if (starts.size() == 1) return false;
        for (const Row start : starts) flaws.add(Flaw::pieces, {start, 0});
        return true;
    }

    static constexpr std::size_t ahead = 16;
    static constexpr Row nowhere = ~Row{0};

    const Subject& subject_;
    const std::vector<Side>& border_;
    ThreadPool& pool_;
    Buffer<Row> next_;  // of each row that the border goes through
};

}  // namespace

bool follow_border(const Subject& subject, const std::vector<Side>& border, ThreadPool& pool,
                   Flaws& flaws) {
    return Border(subject, border, pool).look(flaws);
}

}  // namespace liftmesh
