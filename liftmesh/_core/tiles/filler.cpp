// A flood over the triangles from the left of each rim edge, which crosses no rim edge either way.

#include "tiles/frontier.hpp"

namespace liftmesh {

namespace {

class Rim {
 public:
    Rim(std::span<const RimEdge> edges, std::size_t points) : is_on_(points) {
        edges_.reserve(edges.size());
        for (const RimEdge& e : edges) {
            edges_.push_back(key(e.tail, e.head));
            is_on_[index(e.tail)] = is_on_[index(e.head)] = 1;
        }
        std::sort(edges_.begin(), edges_.end());
    }

    bool holds(std::int32_t tail, std::int32_t head) const {
        return is_on_[index(tail)] && is_on_[index(head)] &&
               std::binary_search(edges_.begin(), edges_.end(), key(tail, head));
    }

 private:
    static std::size_t index(std::int32_t vertex) { return static_cast<std::size_t>(vertex); }
    static std::uint64_t key(std::int32_t tail, std::int32_t head) {
        return std::uint64_t{static_cast<std::uint32_t>(tail)} << 32 |
               static_cast<std::uint32_t>(head);
    }

    std::vector<std::uint64_t> edges_;
    std::vector<std::uint8_t> is_on_;
};

class Flood {
 public:
    Flood(const Result& mesh, const Rim& rim, Ground* ground)
        : mesh_(mesh), rim_(rim), ground_(ground) {}

    // Returns how many rim edges have a triangle on their left.
    std::size_t begin() {
        std::size_t found = 0;
        for (std::size_t t = 0; t < mesh_.triangle_count; ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [tail, head] = edge(t, k);
                if (!rim_.holds(tail, head)) continue;
                ++found;
                mark(t);
            }
        return found;
    }

    void spread() {
        while (!waiting_.empty()) {
            const std::size_t t = waiting_.back();
            waiting_.pop_back();
            for (std::size_t k = 0; k < 3; ++k) cross(t, k);
        }
    }

 private:
    std::pair<std::int32_t, std::int32_t> edge(std::size_t t, std::size_t k) const {
        const std::int32_t* corners = &mesh_.simplices[3 * t];
        return {corners[(k + 1) % 3], corners[(k + 2) % 3]};
    }

    void mark(std::size_t t) {
        if (ground_[t] == Ground::filler) return;
        ground_[t] = Ground::filler;
        waiting_.push_back(t);
    }

    void cross(std::size_t t, std::size_t k) {
        const std::int32_t beyond = mesh_.neighbors[3 * t + k];
        if (beyond < 0) return;
        const auto [tail, head] = edge(t, k);
        if (!rim_.holds(tail, head) && !rim_.holds(head, tail))
            mark(static_cast<std::size_t>(beyond));
    }

    const Result& mesh_;
    const Rim& rim_;
    Ground* ground_;
    std::vector<std::size_t> waiting_;
};

}  // namespace

std::size_t mark_filler(const Result& mesh, std::size_t points, std::span<const RimEdge> rim,
                        Ground* ground) {
    if (rim.empty()) return 0;
    const Rim edges(rim, points);
    Flood flood(mesh, edges, ground);
    const std::size_t found = flood.begin();
    if (found != rim.size()) return rim.size() - found;
    flood.spread();
    return 0;
}

}  // namespace liftmesh
