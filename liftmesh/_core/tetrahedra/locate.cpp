#include "tetrahedra/locate.hpp"

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "sorting/along_curve.hpp"

namespace liftmesh {

namespace {

bool is_finite(const SpacePoint& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

class SpaceWalk {
 public:
    SpaceWalk(const SpaceTriangulation& tetrahedra, const Trust& trust, Interrupt& interrupt)
        : tetrahedra_(tetrahedra), trust_(trust), patience_(interrupt) {}

    // A visibility walk, from where the last one ended, then a search among those that share the
    // facets, edges or vertices that the query is on.
    std::int32_t find(const SpacePoint& query) {
        for (std::size_t steps = 0; steps <= tetrahedra_.count && !patience_.ends(); ++steps) {
            const unsigned exit = exit_towards(last_, query);
            if (exit == 4) return first_around(query);
            const std::int32_t across = neighbor(last_, exit);
            if (across < 0) return -1;
            last_ = across;
        }
        return -1;  // GCOV_EXCL_LINE: of a damaged triangulation, or interrupted
    }

 private:
    std::int32_t neighbor(std::int32_t t, unsigned k) const {
        return tetrahedra_.neighbors[4 * static_cast<std::size_t>(t) + k];
    }

    // On which side of a facet: 1 is inside.
    int side(std::int32_t t, unsigned k, const SpacePoint& query) const {
        const SpacePoint* q[4];
        for (unsigned i = 0; i < 4; ++i)
            q[i] = &tetrahedra_.points[tetrahedra_.simplices[4 * static_cast<std::size_t>(t) + i]];
        q[k] = &query;
        return volume_sign(*q[0], *q[1], *q[2], *q[3], trust_);
    }

    unsigned exit_towards(std::int32_t t, const SpacePoint& query) {
        spans_.fill(true);
        for (unsigned k = 0; k < 4; ++k) {
            const int found = side(t, k, query);
            if (found < 0) return k;
            spans_[k] = found > 0;
        }
        return 4;
    }

    // The corners of the facet, edge or vertex that the last query is on, ascending.
    std::vector<std::int32_t> face() const {
        std::vector<std::int32_t> rows;
        for (std::size_t k = 0; k < 4; ++k)
            if (spans_[k])
                rows.push_back(tetrahedra_.simplices[4 * static_cast<std::size_t>(last_) + k]);
        std::sort(rows.begin(), rows.end());
        return rows;
    }

    // Those that contain the query are the tetrahedra of the facet, edge or vertex that it is on:
    // they are connected by facets that contain it. Where they are many they are looked at once.
    std::int32_t first_around(const SpacePoint& query) {
        constexpr std::size_t many = 64;
        if (spans_ == std::array{true, true, true, true}) return last_;
        if (!known_.empty())
            if (const auto known = known_.find(face()); known != known_.end()) return known->second;
        std::int32_t first = last_;
        seen_.resize(tetrahedra_.count);
        around_.clear();
        see(last_);
        for (std::size_t i = 0; i < around_.size(); ++i) {
            first = std::min(first, around_[i]);
            for (unsigned k = 0; k < 4; ++k)
                if (const std::int32_t t = neighbor(around_[i], k);
                    t >= 0 && side(around_[i], k, query) == 0)
                    see(t);
        }
        for (std::int32_t t : around_) seen_[static_cast<std::size_t>(t)] = false;
        if (around_.size() > many) known_.emplace(face(), first);
        return first;
    }

    void see(std::int32_t t) {
        if (std::exchange(seen_[static_cast<std::size_t>(t)], true)) return;
        around_.push_back(t);
    }

    const SpaceTriangulation& tetrahedra_;
    Trust trust_;
    Patience patience_;
    std::int32_t last_ = 0;
    std::array<bool, 4> spans_{};  // whether each corner is of the face that the query is on
    std::map<std::vector<std::int32_t>, std::int32_t> known_;
    std::vector<std::int32_t> around_;
    std::vector<std::uint8_t> seen_;  // of each tetrahedron, once it is needed
};

using Placed = PlacedRow<HilbertCurveInSpace, std::size_t>;

// False if the interrupt came first.
bool in_order(const SpacePoint* queries, std::size_t count, const SpaceBox& box,
              Interrupt& interrupt, std::vector<Placed>& order) {
    const HilbertCurveInSpace curve(box);
    order.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        if (is_finite(queries[i])) order.push_back({curve(queries[i]), i});
    const auto at = [queries](std::size_t i) -> const SpacePoint& { return queries[i]; };
    AlongCurve<HilbertCurveInSpace, decltype(at), std::size_t>(at, interrupt).sort(order);
    return !interrupt.requested();
}

}  // namespace

SpaceLocator::SpaceLocator(const SpaceTriangulation& tetrahedra) : tetrahedra_(tetrahedra) {
    for (std::size_t i = 0; i < tetrahedra.rows; ++i)
        if (is_finite(tetrahedra.points[i])) scale_.add(tetrahedra.points[i]);
}

bool SpaceLocator::find(const SpacePoint* queries, std::size_t count, Interrupt& interrupt,
                        std::int32_t* found) const {
    const IeeeArithmetic ieee;
    std::fill_n(found, count, -1);
    SpaceScale scale = scale_;
    SpaceBox box;
    for (std::size_t i = 0; i < count; ++i)
        if (is_finite(queries[i])) scale.add(queries[i]), box.add(queries[i]);
    scale.settle();
    SpaceWalk walk(tetrahedra_, scale.moves() ? Trust() : scale.trust(), interrupt);
    std::vector<Placed> order;
    if (!in_order(queries, count, box, interrupt, order)) return false;
    return for_each_in_blocks(order.size(), interrupt,
                              [&](std::size_t i) {
                                  const std::size_t index = order[i].row;
                                  found[index] = walk.find(queries[index]);
                              }) &&
           !interrupt.requested();
}

}  // namespace liftmesh
