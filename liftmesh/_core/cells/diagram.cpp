#include "cells/diagram.hpp"

#include "base/floating_point.hpp"
#include "cells/power_centre.hpp"
#include "parallel/blocks.hpp"
#include "predicates/lifted_side.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t block = std::size_t{1} << 14;
constexpr std::int32_t none = -1;

int side(const Paraboloid&, const Lifted<Paraboloid>& a, const Lifted<Paraboloid>& b,
         const Lifted<Paraboloid>& c, const Lifted<Paraboloid>& d) {
    return incircle_exact(a.point, b.point, c.point, d.point, Guard::anywhere());
}
template <class Lift>
int side(const Lift& lift, const Lifted<Lift>& a, const Lifted<Lift>& b, const Lifted<Lift>& c,
         const Lifted<Lift>& d) {
    return lifted_side_exact(lift, a, b, c, d, Guard::anywhere());
}

// The first triangle of its vertex, as far as it is known; entries lead to lesser ones.
class Roots {
 public:
    explicit Roots(Buffer<std::int32_t>& roots) : root_(roots.get()) {}

    std::int32_t of(std::int32_t t) const {
        while (root_[t] != t) t = root_[t] = root_[root_[t]];
        return t;
    }
    void join(std::int32_t s, std::int32_t t) {
        const std::int32_t p = of(s), q = of(t);
        root_[std::max(p, q)] = std::min(p, q);
    }

 private:
    std::int32_t* root_;
};

template <class Lift>
class Making {
 public:
    Making(const Lift& lift, const Dual& dual, Vertices& vertices, ThreadPool& pool)
        : lift_(lift), dual_(dual), made_(vertices), pool_(pool) {}

    bool run() { return find_centres() && join_triangles() && number_vertices(); }

 private:
    std::int32_t vertex(std::int32_t t, int k) const { return dual_.vertex(t, k); }
    std::int32_t neighbor(std::int32_t t, int k) const { return dual_.neighbor(t, k); }

    Lifted<Lift> site(std::int32_t row) const {
        if constexpr (std::is_same_v<Lift, Paraboloid>)
            return {dual_.points[row], {}};
        else
            return {dual_.points[row], dual_.values[row]};
    }

    // Calls visit(t) for every triangle, in order.
    template <class Visit>
    bool for_each_triangle(Visit visit) {
        return for_each_in_blocks(dual_.count, pool_.interrupt(),
                                  [&](std::size_t t) { visit(static_cast<std::int32_t>(t)); });
    }

    Guard guard() const {
        for (std::size_t row = 0; row < dual_.rows; ++row)
            if (!is_in_window(site(static_cast<std::int32_t>(row)))) return Guard::anywhere();
        return Guard::in_window();
    }

    bool find_centres() {
        guard_ = guard();
        made_.points = allocate<Point>(dual_.count);
        return in_blocks(dual_.count, block, pool_,
                         [this](std::size_t first, std::size_t last, std::size_t) {
                             const IeeeArithmetic ieee;
                             for (std::size_t t = first; t < last; ++t) {
                                 prefetch(t + 16);
                                 made_.points[t] = centre(static_cast<std::int32_t>(t));
                             }
                         });
    }

    // Inline always: GCC drops calls of functions that do nothing but prefetch, as without effect.
    [[gnu::always_inline]] void prefetch(std::size_t t) const {
        for (std::size_t k = 3 * t; k < 3 * std::min(t + 1, dual_.count); ++k)
            __builtin_prefetch(dual_.points + dual_.simplices[k]);
    }

    Point centre(std::int32_t t) const {
        return power_centre<Lift>(
            lift_, {site(vertex(t, 0)), site(vertex(t, 1)), site(vertex(t, 2))}, guard_);
    }

    // Equal centres are equal once rounded, so the exact test is asked of few pairs.
    bool join_triangles() {
        made_.of = allocate<std::int32_t>(dual_.count);
        Roots roots(made_.of);
        return for_each_triangle([&](std::int32_t t) {
            made_.of[t] = t;
            for (int k = 0; k < 3; ++k) {
                const std::int32_t other = neighbor(t, k);
                if (other < t && other != none && made_.points[t] == made_.points[other] &&
                    are_coplanar(t, other))
                    roots.join(t, other);
            }
        });
    }

    bool are_coplanar(std::int32_t t, std::int32_t other) const {
        int k = 0;
        while (neighbor(other, k) != t) ++k;
        return side(lift_, site(vertex(t, 0)), site(vertex(t, 1)), site(vertex(t, 2)),
                    site(vertex(other, k))) == 0;
    }

    // Vertices are numbered by their first triangles, and moved to their places.
    bool number_vertices() {
        std::int32_t next = 0;
        return for_each_triangle([&](std::int32_t t) {
            std::int32_t& own = made_.of[t];
            if (own != t) {  // the entry leads to a triangle that has its number already
                own = made_.of[own];
                return;
            }
            own = next;
            const Point at = made_.points[t];
            made_.infinite += std::isinf(at.x) || std::isinf(at.y);
            made_.points[next++] = at;
            made_.count = static_cast<std::size_t>(next);
        });
    }

    const Lift lift_;
    const Dual& dual_;
    Vertices& made_;
    ThreadPool& pool_;
    Guard guard_ = Guard::anywhere();
};

}  // namespace

bool make_vertices(const Dual& dual, Threads threads, Interrupt& interrupt, Vertices& vertices) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads, interrupt);
    switch (dual.kind) {
        case Dual::Kind::plain:
            return Making<Paraboloid>({}, dual, vertices, pool).run();
        case Dual::Kind::weights:
            return Making<ByWeight>({}, dual, vertices, pool).run();
        case Dual::Kind::radii:
            return Making<ByRadius>({}, dual, vertices, pool).run();
    }
    return true;
}

namespace {

constexpr int after(int k) {
    return k == 2 ? 0 : k + 1;
}
constexpr int before(int k) {
    return k == 0 ? 2 : k - 1;
}

}  // namespace

Spokes::Spokes(const Dual& dual, const std::int32_t* chain, std::size_t length)
    : dual_(dual), chain_(chain), length_(length), first_(allocate<std::int32_t>(dual.rows)) {
    std::fill_n(first_.get(), dual.rows, none);
    for (std::size_t i = 0; i < length; ++i) first_[chain[i]] = static_cast<std::int32_t>(i);
    // At a row on the hull, the triangle from which all others are reached counter-clockwise.
    for (std::size_t t = 0; t < dual.count; ++t)
        for (int k = 0; k < 3; ++k) {
            std::int32_t& first = first_[dual.vertex(static_cast<std::int32_t>(t), k)];
            if (first == none || dual.neighbor(static_cast<std::int32_t>(t), before(k)) == none)
                first = static_cast<std::int32_t>(t);
        }
}

void Spokes::list(std::int32_t row, std::vector<Spoke>& found) const {
    found.clear();
    const std::int32_t start = first_[row];
    if (length_ > 0) {
        if (start > 0) found.push_back({chain_[start - 1], none});
        if (static_cast<std::size_t>(start) + 1 < length_)
            found.push_back({chain_[start + 1], none});
        return;
    }
    std::int32_t t = start, next = start;
    do {
        t = next;
        const int k = dual_.place(t, row);
        found.push_back({dual_.vertex(t, after(k)), t});
        next = dual_.neighbor(t, after(k));
        if (next == none) found.push_back({dual_.vertex(t, before(k)), none});
    } while (next != none && next != start);
}

std::int32_t Spokes::any() const {
    if (length_ > 0) return chain_[0];
    return dual_.count > 0 ? dual_.vertex(0, 0) : none;
}

}  // namespace liftmesh
