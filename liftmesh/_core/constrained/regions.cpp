#include "constrained/regions.hpp"

namespace liftmesh::constrained {

namespace {

class Carver {
 public:
    Carver(const Marked& mesh, const std::int32_t* simplices, const Bounds& bounds)
        : mesh_(mesh), simplices_(simplices), bounds_(bounds), places_(mesh.count) {
        if (!bounds.pieces.empty()) starts_.assign(bounds.pieces.back().first + std::size_t{2}, 0);
        for (const Piece& each : bounds.pieces) ++starts_[each.first + std::size_t{1}];
        std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
        const std::size_t count = bounds.pieces.size();
        has_winding_ = std::any_of(bounds.winding, bounds.winding + 2 * count,
                                   [](std::int32_t winding) { return winding != 0; });
        all_bound_ = !has_winding_ &&
                     std::find(bounds.bounds, bounds.bounds + count, 0) == bounds.bounds + count;
    }

    void cut(Carving carving, std::vector<std::uint8_t>& kept) {
        find_places();
        for (std::size_t t = 0; t < mesh_.count; ++t) {
            const auto [depth, winding] = places_[t];
            const bool is_inside = has_winding_ ? winding.is_inside() : depth % 2 == 1;
            kept[t] = carving == Carving::holes ? is_inside : depth > 0;
        }
    }

    // Of a region, all triangles are left or none.
    void remove_region(std::size_t seed, std::vector<std::uint8_t>& kept) {
        std::vector<std::size_t> stack{seed};
        while (!stack.empty()) {
            const std::size_t t = stack.back();
            stack.pop_back();
            if (!std::exchange(kept[t], 0)) continue;
            for (unsigned k = 0; k < 3; ++k)
                if (mesh_.neighbor(t, k) >= 0 && !side(t, k).bounds)
                    stack.push_back(static_cast<std::size_t>(mesh_.neighbor(t, k)));
        }
    }

 private:
    static constexpr std::int32_t unknown = std::numeric_limits<std::int32_t>::max();

    // How often outer rings wind around a place, and how often holes do.
    struct Winding {
        std::int32_t outer = 0, holes = 0;

        bool is_inside() const { return std::abs(outer) > std::abs(holes); }
    };

    // How many pieces that bound are between a triangle and the outside, at least.
    struct Place {
        std::int32_t depth = unknown;
        Winding winding;
    };

    // A side, crossed into its triangle.
    struct Side {
        bool bounds = false;
        Winding winding;

        Side outward() const { return {bounds, {-winding.outer, -winding.holes}}; }
    };

    Side side(std::size_t t, unsigned k) const {
        if (!mesh_.is_marked(t, k)) return {};
        if (all_bound_) return {true, {}};
        const auto tail = static_cast<Row>(simplices_[3 * t + (k + 1) % 3]);
        const auto head = static_cast<Row>(simplices_[3 * t + (k + 2) % 3]);
        const Piece piece{std::min(tail, head), std::max(tail, head)};
        if (piece.first + std::size_t{1} >= starts_.size()) return {};
        const std::uint32_t begin = starts_[piece.first], end = starts_[piece.first + 1];
        const auto those = bounds_.pieces.subspan(begin, end - begin);
        const auto at = std::lower_bound(those.begin(), those.end(), piece);
        if (at == those.end() || *at != piece) return {};
        const std::size_t i = begin + static_cast<std::size_t>(at - those.begin());
        const std::int32_t sign = tail < head ? 1 : -1;
        const std::int32_t* const its = &bounds_.winding[2 * i];
        return {bounds_.bounds[i] != 0, {sign * its[0], sign * its[1]}};
    }

    // Level by level: first all triangles that can be reached without a further piece.
    void find_places() {
        for (std::size_t t = 0; t < mesh_.count; ++t)
            for (unsigned k = 0; k < 3; ++k)
                if (mesh_.neighbor(t, k) < 0) enter(t, side(t, k), {0, {}});
        for (; !level_.empty() || !later_.empty(); std::swap(level_, later_)) {
            while (!level_.empty()) {
                const auto [t, place] = level_.back();
                level_.pop_back();
                if (places_[t].depth != unknown) continue;
                places_[t] = place;
                for (unsigned k = 0; k < 3; ++k) leave(t, k);
            }
        }
    }

    void leave(std::size_t t, unsigned k) {
        const std::int32_t other = mesh_.neighbor(t, k);
        if (other < 0) return;
        const auto next = static_cast<std::size_t>(other);
        if (places_[next].depth == unknown) enter(next, side(t, k).outward(), places_[t]);
    }

    void enter(std::size_t t, const Side& crossed, const Place& from) {
        const Place place{from.depth + crossed.bounds,
                          {from.winding.outer + crossed.winding.outer,
                           from.winding.holes + crossed.winding.holes}};
        (crossed.bounds ? later_ : level_).push_back({t, place});
    }

    struct Step {
        std::size_t triangle;
        Place place;
    };

    const Marked& mesh_;
    const std::int32_t* simplices_;
    const Bounds& bounds_;
    bool has_winding_, all_bound_;
    std::vector<std::uint32_t> starts_;  // of pieces by their first row
    std::vector<Place> places_;
    std::vector<Step> level_, later_;  // of this depth, and of the next
};

}  // namespace

std::vector<std::int32_t> label(const Marked& mesh) {
    constexpr std::int32_t none = -1;
    std::vector<std::int32_t> labels(mesh.count, none);
    std::vector<std::size_t> stack;
    std::int32_t regions = 0;
    for (std::size_t first = 0; first < mesh.count; ++first) {
        if (labels[first] != none) continue;
        labels[first] = regions;
        stack.push_back(first);
        while (!stack.empty()) {
            const std::size_t t = stack.back();
            stack.pop_back();
            for (unsigned k = 0; k < 3; ++k) {
                const std::int32_t other = mesh.neighbor(t, k);
                if (other < 0 || mesh.is_marked(t, k)) continue;
                std::int32_t& its = labels[static_cast<std::size_t>(other)];
                if (its == none) stack.push_back(static_cast<std::size_t>(other));
                its = regions;
            }
        }
        ++regions;
    }
    return labels;
}

std::vector<std::uint8_t> carve(const Marked& mesh, const std::int32_t* simplices,
                                const Bounds& bounds, Carving carving,
                                std::span<const std::int32_t> seeds) {
    std::vector<std::uint8_t> kept(mesh.count, 1);
    Carver carver(mesh, simplices, bounds);
    if (carving != Carving::none) carver.cut(carving, kept);
    for (const std::int32_t seed : seeds)
        carver.remove_region(static_cast<std::size_t>(seed), kept);
    return kept;
}

}  // namespace liftmesh::constrained
