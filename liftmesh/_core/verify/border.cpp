#include "verify/border.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr Row nowhere = ~Row{0};

class Border {
 public:
    Border(const Subject& subject, Team& team, Flaws& flaws)
        : subject_(subject), team_(team), flaws_(flaws), next_(subject.rows, nowhere) {}

    bool follow(const std::vector<Side>& border) {
        for (const Side& side : border) {
            if (next_[side.tail] != nowhere) flaws_.add(Flaw::pinched, {side.tail, 0});
            next_[side.tail] = side.head;
        }
        if (flaws_.any(Flaw::pinched)) return true;
        const std::size_t curves = find_curves(border);
        if (curves > 1 || border.empty()) return true;
        return look_at_turns();
    }

 private:
    // The last of them stays in `curve_`. Each triangle's sides close up, so do those that are
    // left.
    std::size_t find_curves(const std::vector<Side>& border) {
        std::vector<Row> starts;
        for (const Side& side : border) {
            if (next_[side.tail] == nowhere) continue;
            curve_.clear();
            starts.push_back(side.tail);
            for (Row at = side.tail; at != nowhere; at = std::exchange(next_[at], nowhere))
                curve_.push_back(at);
            curve_.pop_back();  // the first once more
        }
        if (starts.size() > 1)
            for (const Row start : starts) flaws_.add(Flaw::pieces, {start, 0});
        return starts.size();
    }

    bool look_at_turns() {
        std::vector<Flaws> found(blocks(curve_.size()));
        std::vector<std::size_t> least(found.size());
        const bool done = team_.run(found.size(), [&](std::size_t task) {
            const std::size_t last = std::min(curve_.size(), (task + 1) * block);
            for (std::size_t i = task * block; i < last; ++i) least[task] += turn(i, found[task]);
        });
        for (const Flaws& some : found) flaws_.add(some);
        const std::size_t rounds = std::accumulate(least.begin(), least.end(), std::size_t{0});
        if (done && rounds != 1 && !flaws_.any(Flaw::hull))
            flaws_.add(Flaw::winding, {curve_.front(), rounds});
        return done;
    }

    // Looks at the turn of the curve at its row i. Whether the row comes before both its neighbours
    // in the order by x, then y: a curve that only turns left has one such row for each round.
    bool turn(std::size_t i, Flaws& flaws) const {
        const Row row = curve_[i];
        const Row before = curve_[i == 0 ? curve_.size() - 1 : i - 1];
        const Row after = curve_[i + 1 == curve_.size() ? 0 : i + 1];
        const Point a = subject_.points[before], b = subject_.points[row];
        const Point c = subject_.points[after];
        const int side = orient2d(a, b, c);
        const bool goes_on = before_xy(a, b) == before_xy(b, c);  // and does not turn back
        if (side < 0 || (side == 0 && !goes_on))
            flaws.add(Flaw::hull, {row, std::uint64_t{before} << 32 | after});
        return before_xy(b, a) && before_xy(b, c);
    }

    const Subject& subject_;
    Team& team_;
    Flaws& flaws_;
    std::vector<Row> next_;
    std::vector<Row> curve_;
};

}  // namespace

bool follow_border(const Subject& subject, const std::vector<Side>& border, Team& team,
                   Flaws& flaws) {
    return Border(subject, team, flaws).follow(border);
}

}  // namespace liftmesh
