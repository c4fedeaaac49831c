#include "proximity/relative.hpp"

#include "base/components.hpp"
#include "parallel/blocks.hpp"
#include "predicates/distances.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh {

namespace {

class Elimination {
 public:
    explicit Elimination(const EdgeSides& sides) : sides_(sides), next_(sides.count(), remaining) {}

    // Follows the path that begins at a side, from the corner opposite.
    void follow(Side from) {
        const Point p = sides_.place(sides_.opposite(from));
        for (Side at = first_remaining(from); at != no_side && eliminates(p, at);
             at = first_remaining(at)) {
            const Side further = onwards(at);
            // No path comes back, but what is joined by several might.
            next_[at] = further != no_side && first_remaining(further) == at ? no_side : further;
        }
    }

    bool remains(Side side) const {
        const Side beyond = sides_.across(side);
        return next_[side] == remaining && (beyond == no_side || next_[beyond] == remaining);
    }

 private:
    static constexpr Side remaining = no_side - 1;

    bool eliminates(Point p, Side side) const {
        const Point a = sides_.place(sides_.tail(side)), b = sides_.place(sides_.head(side));
        return compare_distances(p, a, a, b) < 0 && compare_distances(p, b, a, b) < 0;
    }

    // The longer of the two other sides beyond.
    Side onwards(Side side) const {
        const Side beyond = sides_.across(side);
        if (beyond == no_side) return no_side;
        const Side after = beyond % 3 == 2 ? beyond - 2 : beyond + 1;
        const Side before = beyond % 3 == 0 ? beyond + 2 : beyond - 1;
        const auto end = [&](Side at) { return sides_.place(sides_.opposite(at)); };
        const Point c = end(beyond);
        // The side after ends at what the one before is opposite to.
        const int order = compare_distances(c, end(before), c, end(after));
        return order == 0 ? no_side : order > 0 ? after : before;
    }

    Side first_remaining(Side side) {
        while (side != no_side && next_[side] != remaining) {
            const Side further = next_[side];
            if (further != no_side && next_[further] != remaining) next_[side] = next_[further];
            side = further;
        }
        return side;
    }

    const EdgeSides& sides_;
    std::vector<Side> next_;  // of eliminated sides: what their paths go on to
};

// The lesser end first.
struct Candidate {
    double square;
    Point lesser, greater;
    Edge edge;
};

Candidate candidate(const EdgeSides& sides, Edge edge) {
    Point a = sides.place(edge[0]), b = sides.place(edge[1]);
    if (before_xy(b, a)) std::swap(a, b);
    return {square_of_distance(a, b), a, b, edge};
}

bool is_shorter(const Candidate& e, const Candidate& f) {
    const double difference = e.square - f.square;
    const double error = 0x1p-50 * (e.square + f.square) + 0x1p-1000;
    if (std::fabs(difference) > error) return difference < 0;
    const int order = compare_distances_exact(e.lesser, e.greater, f.lesser, f.greater);
    if (order != 0) return order < 0;
    return e.lesser == f.lesser ? before_xy(e.greater, f.greater) : before_xy(e.lesser, f.lesser);
}

}  // namespace

bool find_relative_neighbors(const EdgeSides& sides, Interrupt& interrupt, Edges& edges) {
    Elimination elimination(sides);
    return for_each_in_blocks(
               sides.count(), interrupt,
               [&](std::size_t side) { elimination.follow(static_cast<Side>(side)); }) &&
           for_each_in_blocks(sides.count(), interrupt, [&](std::size_t i) {
               const auto side = static_cast<Side>(i);
               if (sides.is_first(side) && elimination.remains(side))
                   edges.push_back({sides.tail(side), sides.head(side)});
           });
}

bool span(const EdgeSides& sides, Interrupt& interrupt, Edges& edges) {
    std::vector<Candidate> candidates;
    candidates.reserve(edges.size());
    for (const Edge& edge : edges) candidates.push_back(candidate(sides, edge));
    if (!patient_sort(candidates, is_shorter, interrupt)) return false;
    Components parts(sides.points().size());
    for (std::size_t vertex = 0; vertex < sides.points().size(); ++vertex) parts.add(vertex);
    edges.clear();
    return for_each_in_blocks(candidates.size(), interrupt, [&](std::size_t i) {
        const auto [a, b] = candidates[i].edge;
        if (parts.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b)))
            edges.push_back({a, b});
    });
}

}  // namespace liftmesh
