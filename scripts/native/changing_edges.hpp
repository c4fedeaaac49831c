// Points and constraints that come and go together.
#pragma once

#include <algorithm>
#include <vector>

#include "dynamic/triangulation.hpp"

namespace native {

using liftmesh::dynamic::Triangulation;

// Constraints between vertices so many numbers apart; what crosses others is refused.
inline void insert_constraints(Triangulation& mesh, std::size_t apart) {
    for (liftmesh::Vertex v = 0; v + apart < mesh.vertex_end(); v += 3)
        if (const auto w = static_cast<liftmesh::Vertex>(v + apart);
            mesh.is_present(v) && mesh.is_present(w))
            mesh.insert_constraint(v, w);
}

// Every second constraint, or all.
inline void remove_constraints(Triangulation& mesh, std::size_t step) {
    const auto wholes = mesh.constraints().wholes();
    std::size_t i = 0;
    for (const auto& [a, b] : wholes)
        if (i++ % step == 0) mesh.remove_constraint(a, b);
}

inline std::vector<liftmesh::Vertex> not_held(const Triangulation& mesh, std::size_t step) {
    std::vector<liftmesh::Vertex> found;
    for (liftmesh::Vertex v = 0; v < mesh.vertex_end(); v += step)
        if (mesh.is_present(v) && mesh.holders(v).empty()) found.push_back(v);
    return found;
}

// Half of the points, edges, the rest at once, which splits edges, and edges between all; vertices
// go, one by one and at once, then edges. Calls told(mesh) after each; at the end no edge is left.
template <class Told>
void change_edges(const std::vector<liftmesh::Point>& points, Told told) {
    liftmesh::NoInterrupt never;
    Triangulation mesh;
    std::vector<liftmesh::Vertex> numbers(points.size());
    const std::size_t half = points.size() / 2;
    for (std::size_t i = 0; i < half; ++i) mesh.insert(points[i]);
    insert_constraints(mesh, 1);
    told(mesh);
    const std::vector<liftmesh::Point> rest(points.begin() + static_cast<std::ptrdiff_t>(half),
                                            points.end());
    mesh.insert(liftmesh::dynamic::input_of(rest), numbers.data(), never);
    insert_constraints(mesh, 7);
    told(mesh);
    for (const liftmesh::Vertex v : not_held(mesh, 5)) mesh.remove(v);
    const auto gone = not_held(mesh, 2);
    mesh.remove(gone.data(), gone.size(), never);
    told(mesh);
    for (const std::size_t step : {2, 1}) {
        remove_constraints(mesh, step);
        told(mesh);
    }
}

}  // namespace native
