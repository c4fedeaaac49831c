// Constraints: segments that are to be unions of edges.
#pragma once

#include "base/buffer.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/sides.hpp"

namespace liftmesh {

// The edges of the triangles that constraints run along.
class ConstrainedEdges {
 public:
    explicit ConstrainedEdges(const MeshView& mesh) : mesh_(mesh) {}

    // False if the interrupt came first.
    bool collect(ThreadPool& pool);

    // Marks the edges that run along the segment between two rows, from the lesser on; returns
    // where they end. Corners are named by the lowest rows of their positions.
    Row follow(Row from, Row to);

    // Whether the edge opposite that corner is marked.
    bool contain(std::uint32_t place) const { return !chain_.empty() && chain_[place] != none; }

 private:
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    Row ends_at(std::uint32_t place) const;
    std::uint32_t edge_towards(Row from, Row to) const;
    std::uint32_t last_of_chain(std::uint32_t place);

    const MeshView& mesh_;
    std::vector<std::uint32_t> first_;  // of each row, and the end: where its edges are
    Buffer<std::uint32_t> edges_;       // the places of half-edges, by their lesser ends
    std::vector<std::uint32_t> chain_;  // for each place that is marked one further on, or itself
};

// A constraint between the lowest rows of its ends, the lesser first, and where edges along it end.
struct Segment {
    Row from, to, reached;
};

// Triangles whose corners are named by the lowest rows of their positions.
struct NamedMesh {
    const MeshView& mesh;
    const std::vector<Row>& lowest;  // of each row: the lowest at its position
    const Marks& corners;
    const std::vector<HalfEdge>& boundary;
    ThreadPool& pool;
};

// Checks the boundary of carved triangles (carving.cpp), and follows the segments that leave them.
// Counts the rows outside; not if it finds that triangles overlap. False if the interrupt came
// first.
bool check_carving(const NamedMesh& named, const std::vector<Segment>& segments,
                   ConstrainedEdges& edges, Flaws& flaws, std::optional<std::size_t>& outside);

// Adds every constraint that is no union of edges, and removes edges along constraints from
// `pairing.flippable`. Where these are carved, checks the boundary too. False if the interrupt came
// first.
bool check_constraints(const NamedMesh& named, const Constraints& constraints, EdgePairing& pairing,
                       Flaws& flaws, std::optional<std::size_t>& outside);

}  // namespace liftmesh
