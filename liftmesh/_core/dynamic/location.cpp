// Location by the visibility walk, which ends in every regular triangulation (Edelsbrunner 1990).
// With constraints it may go in a circle, but for the edges being tried in random order (Devillers,
// Pion and Teillaud, "Walking in a triangulation", 2002).
// Without a hint it starts at a vertex in the same cell of a grid (hints.hpp), or at the nearest of
// some sampled vertices (Muecke, Saias and Zhu, "Fast
// randomized point location without preprocessing", 1996).
#include "dynamic/triangulation.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/sample.hpp"

namespace liftmesh::dynamic {

namespace {

// Whether p, on the line of a and b, is strictly between them.
bool is_between(Point a, Point p, Point b) {
    return (before_xy(a, p) && before_xy(p, b)) || (before_xy(b, p) && before_xy(p, a));
}

constexpr unsigned turns[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};

}  // namespace

// A ghost conflicts with what is beyond its hull edge, or on it.
bool Triangulation::is_outside(TriangleId t, Point p) const {
    const Point head = points_[slots_.vertex(t, 0)], tail = points_[slots_.vertex(t, 1)];
    const int turn = orient2d(tail, head, p);
    return turn < 0 || (turn == 0 && is_between(tail, p, head));
}

bool Triangulation::conflicts(TriangleId t, Point p) const {
    if (slots_.is_ghost(t)) return is_outside(t, p);
    return incircle_canonical(points_[slots_.vertex(t, 0)], points_[slots_.vertex(t, 1)],
                              points_[slots_.vertex(t, 2)], p, guard_);
}

// The cube root of the number of points balances the sample and the walk. Distances that overflow
// lose their comparison, which costs a longer walk.
Vertex Triangulation::nearest_of_sample(Point p) const {
    const auto distance = [&](Vertex v) {
        const double dx = points_[v].x - p.x, dy = points_[v].y - p.y;
        return dx * dx + dy * dy;
    };
    Vertex nearest = is_present(last_) ? last_ : order_[0];
    double least = distance(nearest);
    for (std::size_t i = 0; i * i * i < size_; ++i) {
        const Vertex v = order_[sample_place(i + size_, size_)];
        if (!(distance(v) < least)) continue;
        nearest = v;
        least = distance(v);
    }
    return nearest;
}

void Triangulation::make_hints() {
    Bounds box = Bounds::nothing();
    for (std::size_t i = 0; i < size_; ++i) box.add(pair(points_[order_[i]]));
    hints_.make(size_, box);
    for (std::size_t i = 0; i < size_; ++i) hints_.note(points_[order_[i]], order_[i]);
}

Place Triangulation::locate(Point p, Vertex hint) const {
    Vertex start = is_present(hint) ? hint : hints_.near(p, points_);
    if (!is_present(start)) start = nearest_of_sample(p);
    TriangleId t = triangle_of(corner_[start]);
    if (slots_.is_ghost(t)) t = triangle_of(slots_.twin(edge(t, 2)));
    Edge from = nothing;
    for (std::size_t step = 0;; ++step) {
        if (slots_.is_ghost(t)) return {ghost, t};
        Edge crossed = nothing;
        const auto& turn = turns[slots_.has_marks() ? random_number(step, 0) % 3 : 0];
        for (unsigned k = 0; k < 3 && crossed == nothing; ++k) {
            const Edge e = edge(t, turn[k]);
            if (e == from) continue;
            if (orient2d(points_[slots_.tail(e)], points_[slots_.head(e)], p) < 0) crossed = e;
        }
        if (crossed == nothing) break;
        from = slots_.twin(crossed);
        t = triangle_of(from);
    }
    for (unsigned k = 0; k < 3; ++k)
        if (points_[slots_.vertex(t, k)] == p) return {slots_.vertex(t, k), t};
    return {ghost, t};
}

// Turns around both, so that the one with fewer neighbours decides how long it takes.
Edge Triangulation::edge_between(Vertex from, Vertex to) const {
    Edge e = edge_from(from), f = edge_from(to);
    do {
        if (slots_.head(e) == to) return e;
        if (slots_.head(f) == from) return slots_.twin(f);
        e = turned(e);
        f = turned(f);
    } while (e != edge_from(from) && f != edge_from(to));
    return nothing;
}

Vertex Triangulation::find(Point p, Vertex hint) const {
    if (size_ == 0) return ghost;
    if (has_triangles()) return locate(p, hint).vertex;
    const auto found = line_.find(p);
    return found == line_.end() ? ghost : found->second;
}

}  // namespace liftmesh::dynamic
