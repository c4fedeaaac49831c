// The surface of a cavity: the facets between tetrahedra that a new point removes and those that
// stay. With the point each makes a new tetrahedron, and these are joined here.
#pragma once

#include "predicates/insphere.hpp"
#include "tetrahedra/space_mesh.hpp"

namespace liftmesh {

// The tetrahedron that a facet will make with the new point at place k, and the neighbour outside.
struct CavityFacet {
    std::array<Vertex, 4> vertex;
    Word across;
    unsigned k;
    Word slot;
};

// Each edge of a surface is in two facets of it, once in each direction. A square table of few
// numbered vertices needs no search and no branch.
class SmallSurface {
 public:
    // For vertices from `first` on, and the ghost.
    SmallSurface(Vertex first, std::size_t vertices)
        : first_(first), numbers_(vertices + 1, none) {}

    // False if the vertices are too many.
    bool number(const std::vector<CavityFacet>& facets);
    // The tetrahedra that were numbered.
    void join(const std::vector<CavityFacet>& facets, SpaceMesh& mesh);

 private:
    static constexpr std::uint8_t none = 0xff;
    static constexpr unsigned most = 64;
    using Numbers = std::array<std::uint8_t, 3>;

    std::size_t index(Vertex v) const {
        return std::min<std::size_t>(v - first_, numbers_.size() - 1);
    }
    bool number(const CavityFacet& facet, Numbers& numbers);

    Vertex first_;
    std::vector<std::uint8_t> numbers_;  // of the vertices that have one, the ghost last
    std::vector<Vertex> known_;
    std::vector<Numbers> numbered_;
    Word facet_at_[most][most];
};

// The same for any number of vertices, in time linear in the cavity: from facet to facet around
// each edge, through tetrahedra that are to be removed.
class LargeSurface {
 public:
    // While these are still there: what is to be joined. Their neighbours across the surface are no
    // longer known afterwards.
    void find(const std::vector<CavityFacet>& facets, SpaceMesh& mesh);
    void join(SpaceMesh& mesh) const;

 private:
    std::vector<std::pair<Word, Word>> pairs_;
};

}  // namespace liftmesh
