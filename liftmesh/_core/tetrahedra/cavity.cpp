#include "tetrahedra/cavity.hpp"

namespace liftmesh {

namespace {

// The name of an edge is that of the facet on it and the new point.
template <class Visit>
void for_each_edge(const CavityFacet& facet, const std::array<std::uint8_t, 3>& number,
                   Visit visit) {
    const auto& corner = outward[facet.k];
    visit(facet_name(facet.slot, corner[2]), number[0], number[1]);
    visit(facet_name(facet.slot, corner[0]), number[1], number[2]);
    visit(facet_name(facet.slot, corner[1]), number[2], number[0]);
}

// Instead of a neighbour across the surface: which facet of it.
constexpr Word on_surface = Word{1} << 31;

}  // namespace

bool SmallSurface::number(const std::vector<CavityFacet>& facets) {
    known_.clear();
    numbered_.clear();
    const bool is_small = std::all_of(
        facets.begin(), facets.end(),
        [this](const CavityFacet& facet) { return number(facet, numbered_.emplace_back()); });
    for (Vertex v : known_) numbers_[index(v)] = none;
    return is_small;
}

bool SmallSurface::number(const CavityFacet& facet, Numbers& numbers) {
    for (unsigned i = 0; i < 3; ++i) {
        const Vertex v = facet.vertex[outward[facet.k][i]];
        std::uint8_t& known = numbers_[index(v)];
        if (known == none) {
            if (known_.size() == most) return false;
            known = static_cast<std::uint8_t>(known_.size());
            known_.push_back(v);
        }
        numbers[i] = known;
    }
    return true;
}

void SmallSurface::join(const std::vector<CavityFacet>& facets, SpaceMesh& mesh) {
    for (std::size_t i = 0; i < facets.size(); ++i)
        for_each_edge(facets[i], numbered_[i],
                      [this](Word name, unsigned a, unsigned b) { facet_at_[a][b] = name; });
    for (std::size_t i = 0; i < facets.size(); ++i)
        for_each_edge(facets[i], numbered_[i], [&](Word name, unsigned a, unsigned b) {
            mesh[name / 4].across[name % 4] = facet_at_[b][a];
        });
}

void LargeSurface::find(const std::vector<CavityFacet>& facets, SpaceMesh& mesh) {
    const auto behind = [&](const CavityFacet& facet) {
        return mesh[facet.across / 4].across[facet.across % 4];
    };
    for (std::size_t i = 0; i < facets.size(); ++i)
        mesh[behind(facets[i]) / 4].across[facets[i].k] = on_surface | static_cast<Word>(i);
    pairs_.clear();
    for (const CavityFacet& facet : facets) {
        const auto& corner = outward[facet.k];
        for (unsigned i = 0; i < 3; ++i) {
            const Vertex a = facet.vertex[corner[i]], b = facet.vertex[corner[(i + 1) % 3]];
            if (a > b) continue;  // the other facet sees it from b to a
            unsigned from = facet.k, exit = corner[(i + 2) % 3];
            Word next = mesh[behind(facet) / 4].across[exit];
            while (!(next & on_surface)) {
                const Tetrahedron& at = mesh[next / 4];
                from = next % 4;
                exit = 0;
                while (exit == from || at.vertex[exit] == a || at.vertex[exit] == b) ++exit;
                next = at.across[exit];
            }
            pairs_.push_back({facet_name(facet.slot, corner[(i + 2) % 3]),
                              facet_name(facets[next & ~on_surface].slot, from)});
        }
    }
}

void LargeSurface::join(SpaceMesh& mesh) const {
    for (const auto& [facet, other] : pairs_) mesh.join(facet, other);
}

}  // namespace liftmesh
