// Two sides that run along one another, in opposite directions, are an inner edge. Where triangles
// that lie near one another stand near one another in the list, as most programs leave them, nearly
// all sides find their partner while it still waits in a small table (`OpenSides`). What is left
// over is dealt out by the names of the edges: O(n log n) whatever the order.

#include "verify/sides.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <utility>

#include "base/input.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/perturbation.hpp"
#include "verify/open_sides.hpp"
#include "verify/parts.hpp"

namespace liftmesh {

namespace {

// What one task finds.
class Finder {
 public:
    explicit Finder(const Subject& subject) : subject_(subject) {}

    // Whether its corners are finite, and so can be looked at.
    bool look_at(std::size_t triangle) {
        const std::size_t first = 3 * triangle;
        const Point a = subject_.point(first), b = subject_.point(first + 1);
        const Point c = subject_.point(first + 2);
        if (!(is_finite(a) & is_finite(b) & is_finite(c))) {
            for (std::size_t place = first; place < first + 3; ++place)
                if (!is_finite(subject_.point(place)))
                    triangles.add(Flaw::non_finite, {subject_.given(place), 0});
            return false;
        }
        const int turn = orient2d(a, b, c);
        if (turn <= 0)
            triangles.add(turn < 0 ? Flaw::clockwise : Flaw::flat, {subject_.given(first) / 3, 0});
        return true;
    }

    // The places of the two sides of an edge. Edges are looked at together, apart from the meetings
    // in which they are found, so that what they need is fetched meanwhile.
    void meet(std::uint32_t one, std::uint32_t other) {
        for (const std::uint32_t place : {one, other})
            __builtin_prefetch(&subject_.simplices[place]);
        met_[met_count_++] = {one, other};
        if (met_count_ == met_.size()) look_at_met();
    }

    void look_at_met() {
        for (std::size_t i = 0; i < met_count_; ++i) fetch(met_[i]);
        for (std::size_t i = 0; i < met_count_; ++i) look_at(met_[i]);
        inner += std::exchange(met_count_, 0);
    }

    // Two sides that run along one another in the same direction.
    void name_doubled(std::uint32_t one, std::uint32_t other) {
        const Place place = in_order(one, other);
        edges.add(Flaw::doubled, {place.other, place.at});
    }

    std::size_t inner = 0;
    std::vector<Side> left;  // sides without a partner
    Flaws triangles, edges;

 private:
    struct Edge {
        std::uint32_t one, other;
    };

    void fetch(Edge edge) const {
        const std::size_t first = edge.one - edge.one % 3;
        for (const std::size_t place : {first, first + 1, first + 2, std::size_t{edge.other}})
            __builtin_prefetch(&subject_.points[subject_.corner(place)]);
    }

    // Is the apex of the one side outside the circle of the triangle of the other?
    void look_at(Edge edge) {
        const auto [one, other] = edge;
        const std::size_t first = one - one % 3;
        const Point a = subject_.point(first), b = subject_.point(first + 1);
        const Point c = subject_.point(first + 2), d = subject_.point(other);
        const InCircleFilter filter = incircle_filter(a, b, c, d);
        const double error = filter.error + subject_.guard.margin();
        if (-filter.det > error) return;
        const int side = filter.det > error ? 1 : incircle_exact(a, b, c, d, subject_.guard);
        if (side < 0 || (side == 0 && perturbed_sign(a, b, c, d) <= 0)) return;
        if (!turns_left(first) || !turns_left(other - other % 3)) return;  // and has no inside
        const Place place = in_order(one, other);
        if (side > 0) edges.add(Flaw::delaunay, place);
        edges.add(Flaw::canonical, place);
    }

    bool turns_left(std::size_t first) const {
        return orient2d(subject_.point(first), subject_.point(first + 1),
                        subject_.point(first + 2)) > 0;
    }

    Place in_order(std::uint32_t one, std::uint32_t other) const {
        const auto [low, high] = std::minmax({subject_.given(one), subject_.given(other)});
        return {low, high};
    }

    const Subject& subject_;
    std::array<Edge, 64> met_{};
    std::size_t met_count_ = 0;
};

// The triangles of one task, one after the other. Corners are fetched ahead of their use.
class Passing {
 public:
    Passing(const Subject& subject, Finder& found) : subject_(subject), found_(found) {}

    void run(std::size_t first, std::size_t last) {
        constexpr std::size_t ahead = 32;
        for (std::size_t t = first; t < last; ++t) {
            const std::size_t later = 3 * std::min(t + ahead, last - 1);
            for (std::size_t place = later; place < later + 3; ++place)
                __builtin_prefetch(&subject_.points[subject_.corner(place)]);
            pass(t);
        }
        found_.look_at_met();
        open_.for_each([&](const Side& side) { found_.left.push_back(side); });
    }

 private:
    void pass(std::size_t triangle) {
        if (!found_.look_at(triangle)) return;
        for (int k = 0; k < 3; ++k) {
            const Side side = subject_.side(triangle, k);
            std::uint32_t partner = 0;
            if (open_.meet(side, partner, [&](const Side& other) { found_.left.push_back(other); }))
                found_.meet(side.place, partner);
        }
    }

    const Subject& subject_;
    Finder& found_;
    OpenSides open_;
};

std::uint64_t edge_of(const Side& side) {
    const auto [low, high] = std::minmax(side.tail, side.head);
    return std::uint64_t{low} << 32 | high;
}

bool is_forward(const Side& side) {
    return side.tail < side.head;
}

// Sides of one edge: those in one direction, then those in the other.
template <class It>
void match(It first, It middle, It last, Finder& found) {
    for (auto one = first; one != last; ++one)
        if (one != first && one != middle) found.name_doubled(std::prev(one)->place, one->place);
    const auto pairs = std::min(middle - first, last - middle);
    if (std::max(middle - first, last - middle) > 1) {
        found.inner += static_cast<std::size_t>(pairs);  // which of them are one, nothing tells
    } else if (pairs == 1) {
        found.meet(first->place, middle->place);
    }
    found.left.insert(found.left.end(), first + pairs, middle);
    found.left.insert(found.left.end(), middle + pairs, last);
}

void match(std::span<Side> sides, Finder& found) {
    const auto before = [](const Side& p, const Side& q) {
        return std::pair(edge_of(p), is_forward(p)) < std::pair(edge_of(q), is_forward(q));
    };
    if (!std::is_sorted(sides.begin(), sides.end(), before))  // many sides may be one edge's
        std::sort(sides.begin(), sides.end(), before);
    for (auto first = sides.begin(); first != sides.end();) {
        const auto is_other = [&](const Side& side) { return edge_of(side) != edge_of(*first); };
        const auto last = std::find_if(first, sides.end(), is_other);
        match(first, std::find_if(first, last, is_forward), last, found);
        first = last;
    }
}

// Adds up what tasks find, and hands on what they leave.
template <class Work>
bool in_tasks(const Subject& subject, std::size_t tasks, ThreadPool& pool, Sides& sides,
              std::vector<std::vector<Side>>& left, Work work) {
    std::vector<Finder> found(tasks, Finder(subject));
    const bool done = pool.run(tasks, [&](std::size_t task) { work(task, found[task]); });
    left.clear();
    for (Finder& some : found) {
        sides.inner += some.inner;
        sides.triangles.add(some.triangles);
        sides.edges.add(some.edges);
        left.push_back(std::move(some.left));
    }
    return done;
}

bool pair(const Subject& subject, ThreadPool& pool, std::vector<std::vector<Side>>& left,
          Sides& sides) {
    const Parts<Side, HashOfEdge> parts(left, pool);
    if (!parts.whole()) return false;
    const bool done =
        in_tasks(subject, parts.size(), pool, sides, left, [&](std::size_t part, Finder& found) {
            parts.for_each_handful(part, [&](std::span<Side> some) { match(some, found); });
            found.look_at_met();
        });
    for (const std::vector<Side>& some : left)
        sides.border.insert(sides.border.end(), some.begin(), some.end());
    return done;
}

}  // namespace

bool pass_triangles(const Subject& subject, ThreadPool& pool, Sides& sides) {
    std::vector<std::vector<Side>> left;
    const auto pass = [&](std::size_t task, Finder& found) {
        const std::size_t first = task * block, last = std::min(subject.count, first + block);
        Passing(subject, found).run(first, last);
        pool.interrupt().advance(3 * (last - first));
    };
    return in_tasks(subject, blocks(subject.count), pool, sides, left, pass) &&
           pair(subject, pool, left, sides);
}

bool sort_sides(const Subject& subject, ThreadPool& pool, Sides& sides) {
    std::vector<std::vector<Side>> all(blocks(subject.count));
    const bool done = pool.run(all.size(), [&](std::size_t task) {
        const std::size_t last = std::min(subject.count, (task + 1) * block);
        for (std::size_t t = task * block; t < last; ++t)
            for (int k = 0; k < 3; ++k) all[task].push_back(subject.side(t, k));
    });
    return done && pair(subject, pool, all, sides);
}

}  // namespace liftmesh
