// Constraints: segments that are to be unions of edges.
#pragma once

#include "base/buffer.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/sides.hpp"

namespace liftmesh {

// A constraint, and the row at which edges along it end: `to` if it is a union of edges. Otherwise
// `from` is its lesser end.
struct FollowedEdge {
    Row from, to, reached;
    bool is_whole() const { return reached == to; }
};

// The edges of the triangles that constraints run along.
class ConstrainedEdges {
 public:
    ConstrainedEdges(const MeshView& mesh, ThreadPool& pool)
        : mesh_(mesh), pool_(pool), marked_(3 * mesh.count) {}

    // Marks the edges that are segments as a whole. False if the interrupt came first.
    bool match(std::vector<FollowedEdge>& segments);

    // Lists the edges of each vertex, which `follow` needs. False if the interrupt came first.
    bool collect();

    // Marks the edges that run along a segment, from its lesser end on; returns where they end.
    Row follow(Row from, Row to);

    // Whether the edge opposite that corner is marked.
    bool contain(std::uint32_t place) const { return marked_[place] != 0; }

 private:
    struct Edge {
        Row end;
        std::uint32_t place;
    };
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    Edge edge_towards(Row from, Row to) const;
    std::uint32_t last_of_chain(std::uint32_t place);
    Row greater_end(std::uint32_t place) const;

    const MeshView& mesh_;
    ThreadPool& pool_;
    Marks marked_;                      // of each place
    std::vector<std::uint32_t> first_;  // of each row, and the end: where its edges begin
    Buffer<Edge> edges_;                // half-edges of either direction, at their lesser ends
    std::vector<std::uint32_t>
        chain_;  // of each place that was followed: one further on, or itself
};

// Triangles whose corners are the lowest rows of their positions; or without `lowest`, which is
// that row for each one, if all ends of constraints are corners.
struct NamedMesh {
    const MeshView& mesh;
    const std::vector<Row>& lowest;
    const Marks& corners;
    const std::vector<HalfEdge>& boundary;
    ThreadPool& pool;
};

// Checks the boundary of carved triangles (carving.cpp), and follows the segments that leave them.
// Counts the rows outside; not if it finds that triangles overlap. False if the interrupt came
// first.
bool check_carving(const NamedMesh& named, const std::vector<FollowedEdge>& segments,
                   ConstrainedEdges& edges, Flaws& flaws, std::optional<std::size_t>& outside);

// Adds every constraint that is no union of edges, and removes edges along constraints from
// `pairing.flippable`. Of carved triangles, checks the boundary too. False if the interrupt came
// first.
bool check_constraints(const NamedMesh& named, const Constraints& constraints, EdgePairing& pairing,
                       Flaws& flaws, std::optional<std::size_t>& outside);

}  // namespace liftmesh
