// Graphs of points that are near each other.

#include "proximity/proximity.hpp"

#include "bindings/python.hpp"

namespace bindings {

namespace {

using liftmesh::Proximity;
using RowPairs = Array<const std::int32_t, 2>;

Proximity proximity_named(std::string_view name) {
    if (name == "gabriel") return Proximity::gabriel;
    if (name == "relative_neighborhood") return Proximity::relative_neighborhood;
    if (name == "minimum_spanning_tree") return Proximity::minimum_spanning_tree;
    if (name == "sphere_of_influence") return Proximity::sphere_of_influence;
    throw std::invalid_argument("unknown graph");
}

nb::object proximity_graph(const PlanarRows& rows, const Triples& simplices,
                           const Triples& neighbors, std::string_view kind) {
    if (simplices.shape(0) != neighbors.shape(0)) throw std::invalid_argument("lengths differ");
    const liftmesh::Triangulated mesh{read(rows), simplices.data(), neighbors.data(),
                                      simplices.shape(0)};
    const Proximity proximity = proximity_named(kind);
    std::vector<std::array<std::int32_t, 2>> edges;
    run_unlocked([&](auto& interrupt) {
        return liftmesh::find_proximity_graph(mesh, proximity, interrupt, edges);
    });
    return array_of<std::int32_t>(edges);
}

void lengths(const PlanarRows& rows, const RowPairs& edges, const Array<double>& found) {
    if (edges.shape(0) != found.shape(0)) throw std::invalid_argument("lengths differ");
    const Input input = read(rows);
    const auto* pairs = reinterpret_cast<const std::array<std::int32_t, 2>*>(edges.data());
    run_unlocked([&](auto& interrupt) {
        return liftmesh::find_lengths(input, {pairs, edges.shape(0)}, interrupt, found.data());
    });
}

}  // namespace

void bind_proximity(nb::module_& m) {
    m.def("proximity_graph", &proximity_graph, "rows"_a, "simplices"_a, "neighbors"_a, "kind"_a);
    m.def("lengths", &lengths, "rows"_a, "edges"_a, "found"_a);
}

}  // namespace bindings
