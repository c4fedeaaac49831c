#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "surface/facet.hpp"
#include "surface/natural.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t queries_together = std::size_t{1} << 10;

// What some consecutive points have.
struct Block {
    std::vector<std::size_t> counts;
    std::vector<std::int32_t> rows;
    std::vector<double> weights;
};

class Weigher {
 public:
    Weigher(const Triangulated& mesh, Patience& patience) : mesh_(mesh), patience_(patience) {}

    // False if rows were written meanwhile.
    bool add(Point query, std::int32_t simplex, Block& block) {
        shares_.clear();
        if (simplex >= 0 && !weigh(query, simplex)) return false;
        std::sort(shares_.begin(), shares_.end());
        for (const auto& [row, weight] : shares_) {
            block.rows.push_back(row);
            block.weights.push_back(weight);
        }
        block.counts.push_back(shares_.size());
        return true;
    }

 private:
    bool weigh(Point query, std::int32_t simplex) {
        const auto [kind, k] = place_in(mesh_, simplex, query);
        if (kind == Place::beyond) return false;
        if (kind == Place::vertex) {
            shares_ = {{mesh_.vertex(simplex, k), 1.0}};
            return true;
        }
        if (kind == Place::side && mesh_.neighbor(simplex, k) < 0) {
            return on_hull(query, mesh_.vertex(simplex, (k + 1) % 3),
                           mesh_.vertex(simplex, (k + 2) % 3));
        }
        return by_areas(query, simplex);
    }

    bool on_hull(Point query, std::int32_t start, std::int32_t end) {
        for (const double unit : {1.0, 0.25}) {  // the other one if distances leave the doubles
            shares_ = {{start, reach(query, end, unit)}, {end, reach(query, start, unit)}};
            if (normalise()) return true;
        }
        return false;
    }

    bool by_areas(Point query, std::int32_t simplex) {
        NaturalNeighbors neighbors(mesh_, room_);
        const bool is_sound = neighbors.find(query, simplex, patience_);
        if (patience_.ends(0)) return true;
        if (!is_sound || !neighbors.is_around()) return false;
        const std::vector<double>& weights = neighbors.weigh(Natural::sibson);
        for (std::size_t i = 0; i < weights.size(); ++i)
            shares_.push_back({neighbors.row(i), weights[i]});
        return normalise();
    }

    // False if there is no finite sum, or it is 0, since rows were written meanwhile.
    bool normalise() {
        double total = 0;
        for (const Share& each : shares_) total += each.second;
        if (!(total > 0) || !std::isfinite(total)) return false;
        for (Share& each : shares_) each.second /= total;
        return true;
    }

    double reach(Point query, std::int32_t row, double unit) const {
        const Point at = point(mesh_.place(row));
        return std::max(std::fabs(at.x * unit - query.x * unit),
                        std::fabs(at.y * unit - query.y * unit));
    }

    using Share = std::pair<std::int32_t, double>;

    const Triangulated& mesh_;
    Patience& patience_;
    NaturalNeighbors::Room room_;
    std::vector<Share> shares_;
};

void append(NaturalWeights& found, const Block& block) {
    for (const std::size_t count : block.counts)
        found.starts.push_back(found.starts.back() + static_cast<std::int64_t>(count));
    found.rows.insert(found.rows.end(), block.rows.begin(), block.rows.end());
    found.weights.insert(found.weights.end(), block.weights.begin(), block.weights.end());
}

}  // namespace

bool natural_weights(const Triangulated& mesh, const Queries& queries,
                     const std::int32_t* simplices, NaturalWeights& found, Threads threads,
                     Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(queries.count), interrupt);
    std::vector<Block> made(blocks(queries.count, queries_together));
    std::atomic<bool> is_sound = true;
    const bool done =
        in_blocks(queries.count, queries_together, pool,
                  [&](std::size_t first, std::size_t last, std::size_t at) {
                      Patience patience(pool.interrupt());
                      Weigher weigher(mesh, patience);
                      for (std::size_t i = first; i < last && !patience.ends() && is_sound; ++i)
                          if (!weigher.add(queries[i], simplices[i], made[at])) is_sound = false;
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
