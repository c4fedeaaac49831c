// Removal: the star of a vertex gives way to the triangles of its neighbours.
//
// The hole has few corners nearly always. Then the apex of the triangle at an edge is found by
// trying each, which cuts the hole in two (as T. Anglada does for constraints, 1997): quadratic in
// the number of corners. Where they are many, the neighbours are triangulated by themselves. Edges
// of the hole are edges of that triangulation, too, and its triangles inside the hole are wanted:
// both conflict with no neighbour.
#include <limits>
#include <utility>

#include "dynamic/hole.hpp"
#include "dynamic/triangulation.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::dynamic {

void Triangulation::find_star(Vertex v, Star& star) const {
    find_star(v, std::numeric_limits<std::size_t>::max(), star);
}

bool Triangulation::find_star(Vertex v, std::size_t most, Star& star) const {
    star.triangles.clear();
    star.link.clear();
    star.beyond.clear();
    Edge corner = corner_[v];
    do {
        if (star.link.size() == most) return false;
        star.triangles.push_back(triangle_of(corner));
        star.link.push_back(slots_.tail(corner));
        star.beyond.push_back(slots_.twin(corner));
        corner = next(slots_.twin(next(corner)));
    } while (corner != corner_[v]);
    return true;
}

void Triangulation::plan(const Star& star, Patch& patch) const {
    constexpr std::size_t few = 24;
    const Hole hole{points_.data(), star, guard_};
    patch.clear();
    if (star.link.size() <= few) return hole.cut(patch);
    return hole.is_flat() ? hole.lay_flat(patch) : hole.fit(patch);
}

void Triangulation::replace(Vertex v, const Star& star, const Patch& patch,
                            std::vector<TriangleId>& made) {
    made.resize(patch.count());
    for (const TriangleId t : star.triangles) slots_.drop(t);
    for (std::size_t i = 0; i < made.size(); ++i) {
        const Vertex* corners = &patch.vertices[3 * i];
        made[i] = slots_.make(corners[0], corners[1], corners[2]);
    }
    const auto named = [&](Edge local) {
        return slots_.opposite(made[local / 3], patch.vertices[local]);
    };
    for (Edge e = 0; e < patch.twins.size(); ++e) {
        const Word twin = patch.twins[e];
        slots_.join(named(e), twin & Patch::outside ? twin & ~Patch::outside : named(twin));
        if (patch.vertices[e] != ghost) corner_[patch.vertices[e]] = named(e);
    }
    forget(v);
}

void Triangulation::forget(Vertex v) {
    const Vertex last = order_[--size_];
    std::swap(order_[place_[v]], order_[size_]);
    std::swap(place_[v], place_[last]);
}

void Triangulation::remove(Vertex v) {
    if (!has_triangles()) {
        line_.erase(points_[v]);
        forget(v);
        return;
    }
    find_star(v, removed_);
    if (leaves_a_line(removed_)) {
        lower(removed_);
        forget(v);
        return;
    }
    plan(removed_, patch_);
    replace(v, removed_, patch_, star_triangles_);
}

// Whether all triangles are in the star, and its vertices on one line.
bool Triangulation::leaves_a_line(const Star& star) const {
    std::size_t real = 0;
    for (const TriangleId t : star.triangles) real += !slots_.is_ghost(t);
    return real == slots_.real() && Hole{points_.data(), star, guard_}.is_flat();
}

void Triangulation::lower(const Star& star) {
    Line line;
    for (const Vertex v : star.link)
        if (v != ghost) line.emplace(points_[v], v);
    line_ = std::move(line);
    slots_.clear();
}

}  // namespace liftmesh::dynamic
