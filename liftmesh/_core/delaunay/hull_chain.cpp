#include "delaunay/hull_chain.hpp"

#include <algorithm>
#include <array>

namespace liftmesh {

namespace {

// Goes around the hull counter-clockwise, in all with a step for each corner of each triangle at
// most: modified arrays may know no way around.
class Around {
 public:
    Around(const Triangulated& mesh, std::uint32_t edge, Patience& patience)
        : mesh_(mesh), edge_(edge), steps_(3 * mesh.count), patience_(patience) {}

    std::uint32_t edge() const { return edge_; }

    // The edge opposite corner k runs to the right: the triangle, which is on its left, is above.
    bool is_lower() const {
        const auto triangle = static_cast<std::int32_t>(edge_ / 3);
        const int k = static_cast<int>(edge_ % 3);
        return before_xy(mesh_.corner(triangle, (k + 1) % 3), mesh_.corner(triangle, (k + 2) % 3));
    }

    // Turns around the head of the edge, until there is no neighbour. False if steps have run out.
    bool next() {
        auto at = static_cast<std::int32_t>(edge_ / 3);
        int place = static_cast<int>((edge_ % 3 + 2) % 3);
        const std::int32_t centre = mesh_.vertex(at, place);
        for (; steps_ > 0 && !patience_.ends(); --steps_) {
            const int k = (place + 2) % 3;
            const std::int32_t beyond = mesh_.neighbor(at, k);
            if (beyond < 0) {
                edge_ = static_cast<std::uint32_t>(3 * static_cast<std::size_t>(at)) +
                        static_cast<std::uint32_t>(k);
                return true;
            }
            at = beyond;
            place = mesh_.vertex(at, 0) == centre ? 0 : mesh_.vertex(at, 1) == centre ? 1 : 2;
        }
        return false;
    }

 private:
    const Triangulated& mesh_;
    std::uint32_t edge_;
    std::size_t steps_;
    Patience& patience_;
};

std::uint32_t some_hull_edge(const Triangulated& mesh) {
    const std::int32_t* end = mesh.neighbors + 3 * mesh.count;
    const std::int32_t* at =
        std::find_if(mesh.neighbors, end, [](std::int32_t neighbor) { return neighbor < 0; });
    return at == end ? no_edge : static_cast<std::uint32_t>(at - mesh.neighbors);
}

// The first edges of the upper and of the lower chain, and how many each has.
struct Chains {
    std::array<std::uint32_t, 2> first{no_edge, no_edge};
    std::array<std::size_t, 2> size{};
};

Chains chains(const Triangulated& mesh, std::uint32_t start, Patience& patience) {
    Chains found;
    Around around(mesh, start, patience);
    bool was_lower = around.is_lower();
    do {
        if (!around.next()) break;
        const bool is_lower = around.is_lower();
        if (is_lower != was_lower) found.first[is_lower] = around.edge();
        ++found.size[is_lower];
        was_lower = is_lower;
    } while (around.edge() != start);
    return found;
}

}  // namespace

HullChain::HullChain(const Triangulated& mesh, Patience& patience) : mesh_(mesh) {
    const std::uint32_t start = some_hull_edge(mesh);
    if (start == no_edge) return;
    const Chains found = chains(mesh, start, patience);
    const bool lower = found.size[1] < found.size[0];
    if (found.first[lower] == no_edge) return;
    edges_.reserve(found.size[lower]);
    Around around(mesh, found.first[lower], patience);
    do edges_.push_back(around.edge());
    while (edges_.size() < found.size[lower] && around.next());
    if (!lower) std::reverse(edges_.begin(), edges_.end());
}

std::uint32_t HullChain::at(Point p) const {
    const auto next = std::upper_bound(
        edges_.begin(), edges_.end(), p,
        [&](Point q, std::uint32_t edge) { return before_xy(q, segment(mesh_, edge).left); });
    if (next == edges_.begin() || before_xy(segment(mesh_, next[-1]).right, p)) return no_edge;
    return next[-1];
}

}  // namespace liftmesh
