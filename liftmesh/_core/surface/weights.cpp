#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "surface/sample.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t queries_together = std::size_t{1} << 10;

// What some consecutive points have.
struct Block {
    std::vector<std::size_t> counts;
    std::vector<std::int32_t> rows;
    std::vector<double> weights;
};

// The cases are those of `sample_heights` and `sample_natural`.
class Weigher {
 public:
    Weigher(const Relief& relief, Natural method, Patience& patience, Block& block)
        : relief_(relief),
          mesh_(relief.mesh()),
          method_(method),
          patience_(patience),
          block_(block) {}

    // False if rows were written meanwhile.
    bool add(Point query, std::int32_t simplex) {
        const std::size_t before = block_.rows.size();
        if (!weigh(query, simplex)) return false;
        block_.counts.push_back(block_.rows.size() - before);
        return true;
    }

 private:
    bool weigh(Point query, std::int32_t simplex) {
        if (method_ == Natural::nearest_beyond) {
            if (is_finite(query)) put_nearest(query, simplex);
            return true;
        }
        if (simplex < 0) return true;
        const Place place = relief_.place(query, simplex);
        if (place.kind == Place::beyond) return false;
        if (place.kind == Place::vertex) {
            put_vertex(mesh_.vertex(simplex, place.k), simplex);
        } else if (relief_.is_shown(simplex, place)) {
            return weigh_within(query, simplex, place);
        }
        return true;
    }

    bool weigh_within(Point query, std::int32_t simplex, Place place) {
        const bool is_inside = place.kind == Place::inside;
        if (method_ == Natural::nearest) {
            put_nearest(query, simplex);
        } else if (method_ != Natural::linear &&
                   (is_inside || mesh_.neighbor(simplex, place.k) >= 0)) {
            return put_neighbors(query, simplex);
        } else if (is_inside) {
            put_corners(query, simplex);
        } else {
            put_ends(query, mesh_.vertex(simplex, (place.k + 1) % 3),
                     mesh_.vertex(simplex, (place.k + 2) % 3));
        }
        return true;
    }

    void put(std::int32_t row, double weight) {
        block_.rows.push_back(row);
        block_.weights.push_back(weight);
    }

    void put_vertex(std::int32_t row, std::int32_t simplex) {
        if (relief_.is_shown(simplex) || relief_.owner_of_vertex(row, simplex, patience_) >= 0)
            put(row, 1);
    }

    void put_nearest(Point query, std::int32_t simplex) {
        const std::int32_t row = relief_.nearest(query, simplex, patience_);
        if (row >= 0) put(row, 1);
    }

    void put_ends(Point query, std::int32_t u, std::int32_t v) {
        if (before_xy(place_of(v), place_of(u))) std::swap(u, v);
        const double part = share_between(place_of(u), place_of(v), query);
        put(u, 1 - part);
        put(v, part);
    }

    void put_corners(Point query, std::int32_t simplex) {
        int a = 0;
        for (int k = 1; k < 3; ++k)
            if (before_xy(mesh_.corner(simplex, k), mesh_.corner(simplex, a))) a = k;
        const auto [of_b, of_c] = relief_.facet(simplex).weights(query);
        put(mesh_.vertex(simplex, a), std::max(1 - (of_b + of_c), 0.0));
        put(mesh_.vertex(simplex, (a + 1) % 3), of_b);
        put(mesh_.vertex(simplex, (a + 2) % 3), of_c);
    }

    bool put_neighbors(Point query, std::int32_t simplex) {
        NaturalNeighbors neighbors(mesh_, room_);
        const bool is_sound = neighbors.find(query, simplex, patience_);
        if (patience_.ends(0)) return true;
        if (!is_sound || !neighbors.is_around()) return false;
        const std::vector<double>& weights = neighbors.weigh(method_);
        for (std::size_t i = 0; i < weights.size(); ++i) put(neighbors.row(i), weights[i]);
        return !weights.empty();
    }

    Point place_of(std::int32_t row) const { return point(mesh_.place(row)); }

    const Relief& relief_;
    const Triangulated& mesh_;
    Natural method_;
    Patience& patience_;
    Block& block_;
    NaturalNeighbors::Room room_;
};

void append(PointWeights& found, const Block& block) {
    for (const std::size_t count : block.counts)
        found.starts.push_back(found.starts.back() + static_cast<std::int64_t>(count));
    found.rows.insert(found.rows.end(), block.rows.begin(), block.rows.end());
    found.weights.insert(found.weights.end(), block.weights.begin(), block.weights.end());
}

}  // namespace

bool sample_weights(const Relief& relief, Locator& locator, const Queries& queries, Natural method,
                    PointWeights& found, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    const auto simplices = allocate<std::int32_t>(queries.count);
    if (!locator.find(queries, simplices.get(), threads, interrupt)) return false;
    ThreadPool pool(threads.for_rows(queries.count), interrupt);
    std::vector<Block> made(blocks(queries.count, queries_together));
    std::atomic<bool> is_sound = true;
    const bool done =
        in_blocks(queries.count, queries_together, pool,
                  [&](std::size_t first, std::size_t last, std::size_t at) {
                      Patience patience(pool.interrupt());
                      Weigher weigher(relief, method, patience, made[at]);
                      for (std::size_t i = first; i < last && !patience.ends() && is_sound; ++i)
                          if (!weigher.add(queries[i], simplices[i])) is_sound = false;
                  });
    if (!done || interrupt.requested()) return false;
    found.is_sound = is_sound;
    found.starts = {0};
    for (Block& each : made) {
        if (!found.is_sound) return true;
        append(found, each);
        each = {};
    }
    return true;
}

}  // namespace liftmesh
