// New triangles that are to fill a hole, collected before the mesh changes.
#pragma once

#include "delaunay/mesh.hpp"

namespace liftmesh::dynamic {

// Triangles that are to fill a hole. Edges are named as in `Slots`, from 0; the twin of one at the
// border is an edge outside, with a bit that says so.
struct Patch {
    static constexpr Word outside = Word{1} << 31;  // names of edges are less
    std::vector<Vertex> vertices;
    std::vector<Word> twins;
    std::vector<Edge> marked;  // of those with triangles of the patch on both sides

    std::size_t count() const { return vertices.size() / words_per_triangle; }
    void clear() {
        vertices.clear();
        twins.clear();
        marked.clear();
    }
    Edge add(Vertex a, Vertex b, Vertex c) {
        const auto first = static_cast<Edge>(vertices.size());
        vertices.insert(vertices.end(), {a, b, c});
        twins.insert(twins.end(), {outside, outside, outside});
        return first;
    }
    void join(Edge e, Word other) {
        twins[e] = other;
        if (!(other & outside)) twins[other] = e;
    }
};

}  // namespace liftmesh::dynamic
