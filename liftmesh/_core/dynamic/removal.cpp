// Removal: the star of a vertex gives way to the triangles of its neighbours.
//
// The hole has few corners nearly always. Then the apex of the triangle at an edge is found by
// trying each, which cuts the hole in two (as T. Anglada does for constraints, 1997): quadratic in
// the number of corners. Where they are many, the neighbours are triangulated by themselves. Edges
// of the hole are edges of that triangulation, too, and its triangles inside the hole are wanted:
// both conflict with no neighbour.

#include "dynamic/triangulation.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::dynamic {

namespace {

// The hole that the star of a vertex leaves, and the canonical triangles that fill it.

struct Hole {
    const Point* points;
    const Star& star;
    Guard guard;

    // Whether all vertices of the link are on one line.
    bool is_flat() const;
    void lay_flat(Patch& patch) const;
    // By the apex of one edge after another.
    void cut(Patch& patch) const;
    // By a triangulation of the link.
    void fit(Patch& patch) const;
    // By the one of these that takes the least time.
    void fill(Patch& patch) const;

 private:
    Point at(std::size_t i) const { return points[star.link[i]]; }
    bool is_ghost(std::size_t i) const { return star.link[i] == ghost; }
    bool is_left(std::size_t tail, std::size_t head, std::size_t c) const;
    bool is_better(std::size_t tail, std::size_t head, std::size_t best, std::size_t c) const;
    std::size_t apex(std::size_t first, std::size_t last) const;
    Word cut(std::size_t first, std::size_t last, Patch& patch) const;
};

bool Hole::is_flat() const {
    const std::size_t count = star.link.size();
    std::size_t first = 0, second = 1;
    if (is_ghost(0)) first = 1, second = 2;
    if (is_ghost(1)) second = 2;
    for (std::size_t i = 2; i < count; ++i)
        if (!is_ghost(i) && orient2d(at(first), at(second), at(i)) != 0) return false;
    return true;
}

bool Hole::is_left(std::size_t tail, std::size_t head, std::size_t c) const {
    return orient2d(at(tail), at(head), at(c)) > 0;
}

// Whether the triangle of the edge from `tail` to `head`, seen from inside the hole, rather has the
// apex c than the best so far. Next to the ghost it is the next edge of the hull that counts: no
// point is on its left, and none between its ends.
bool Hole::is_better(std::size_t tail, std::size_t head, std::size_t best, std::size_t c) const {
    const auto is_nearer = [&](std::size_t end) {
        return before_xy(at(end), at(c)) ? before_xy(at(c), at(best)) : before_xy(at(best), at(c));
    };
    if (is_ghost(tail)) {
        const int turn = orient2d(at(head), at(best), at(c));
        return turn > 0 || (turn == 0 && is_nearer(head));
    }
    if (is_ghost(head)) {
        const int turn = orient2d(at(best), at(tail), at(c));
        return turn > 0 || (turn == 0 && is_nearer(tail));
    }
    return incircle_canonical(at(tail), at(head), at(best), at(c), guard);
}

// Of the triangle inside the hole at the chord from the last vertex to the first: a real vertex on
// its left, or else the ghost.
std::size_t Hole::apex(std::size_t first, std::size_t last) const {
    const bool is_real = !is_ghost(first) && !is_ghost(last);
    constexpr std::size_t none = 0;  // never between two others
    std::size_t best = none, fallback = none;
    for (std::size_t c = first + 1; c < last; ++c) {
        if (is_real && is_ghost(c)) fallback = c;
        if (is_real && (is_ghost(c) || !is_left(last, first, c))) continue;
        if (best == none || is_better(last, first, best, c)) best = c;
    }
    return best != none ? best : fallback;
}

// Fills the part from the first to the last vertex; returns its edge at their chord.
Word Hole::cut(std::size_t first, std::size_t last, Patch& patch) const {
    if (last == first + 1) return star.beyond[first] | Patch::outside;
    const std::size_t middle = apex(first, last);
    const Edge t = patch.add(star.link[last], star.link[first], star.link[middle]);
    patch.join(t, cut(first, middle, patch));
    patch.join(t + 1, cut(middle, last, patch));
    return t + 2;
}

void Hole::cut(Patch& patch) const {
    const std::size_t last = star.link.size() - 1;
    patch.join(cut(0, last, patch), star.beyond[last] | Patch::outside);
}

// A ghost at each edge of the line, which the ghost of the link follows.
void Hole::lay_flat(Patch& patch) const {
    const std::size_t count = star.link.size();
    std::size_t g = 0;
    while (!is_ghost(g)) ++g;
    Word before = star.beyond[g] | Patch::outside;
    for (std::size_t i = 1; i + 1 < count; ++i) {
        const std::size_t tail = (g + i) % count, head = (tail + 1) % count;
        const Edge t = patch.add(star.link[tail], star.link[head], ghost);
        patch.join(t + 2, star.beyond[tail] | Patch::outside);
        patch.join(t + 1, before);
        before = t;
    }
    patch.join(before, star.beyond[(g + count - 1) % count] | Patch::outside);
}

// The triangulation of a link, and the places of its vertices there.
class Fitted {
 public:
    Fitted(const Point* points, const std::vector<Vertex>& link) : place_(link.size()) {
        std::vector<Point> real;
        for (const Vertex v : link)
            if (v != ghost) real.push_back(points[v]);
        std::vector<Vertex> found(real.size());
        NoInterrupt never;
        mesh_.insert(input_of(real), found.data(), never);
        std::size_t next = 0;
        for (std::size_t i = 0; i < link.size(); ++i) {
            if (link[i] == ghost)
                place_of_ghost_ = i;
            else
                place_[found[next++]] = i;
        }
    }

    const Slots& slots() const { return mesh_.slots(); }
    std::size_t place(TriangleId t, unsigned k) const {
        const Vertex v = slots().vertex(t, k);
        return v == ghost ? place_of_ghost_ : place_[v];
    }

    // The edge from a vertex of the link, that of a point here, to the next one.
    Edge edge_from(Point tail, std::size_t place_of_head) const {
        Star around;
        mesh_.find_star(mesh_.find(tail), around);
        std::size_t k = 0;
        while (around.link[k] == ghost || place_[around.link[k]] != place_of_head) ++k;
        return previous(slots().twin(around.beyond[k]));
    }

 private:
    Triangulation mesh_;
    std::vector<std::size_t> place_;
    std::size_t place_of_ghost_ = 0;
};

void Hole::fit(Patch& patch) const {
    const std::size_t count = star.link.size();
    const Fitted fitted(points, star.link);
    const std::size_t i = is_ghost(0) || is_ghost(1) ? 2 : 0;
    struct Step {
        Edge entered;
        Word from;
    };
    std::vector<Step> steps{{fitted.edge_from(at(i), i + 1), nothing}};
    while (!steps.empty()) {
        const auto [entered, from] = steps.back();
        steps.pop_back();
        const TriangleId t = triangle_of(entered);
        const std::size_t place[3] = {fitted.place(t, 0), fitted.place(t, 1), fitted.place(t, 2)};
        const Edge local = patch.add(star.link[place[0]], star.link[place[1]], star.link[place[2]]);
        for (unsigned k = 0; k < 3; ++k) {
            const std::size_t tail = place[(k + 1) % 3], head = place[(k + 2) % 3];
            if (head == (tail + 1) % count)
                patch.join(local + k, star.beyond[tail] | Patch::outside);
            else if (edge(t, k) == entered)
                patch.join(local + k, from);
            else
                steps.push_back({fitted.slots().twin(edge(t, k)), local + k});
        }
    }
}

void Hole::fill(Patch& patch) const {
    constexpr std::size_t few_corners = 24;
    if (star.link.size() <= few_corners)
        cut(patch);
    else if (is_flat())
        lay_flat(patch);
    else
        fit(patch);
}

// A part of a star, from one of its vertices to another, on a line with the centre. The edge on
// that line has nothing beyond it yet.
Star half(const Star& star, std::size_t from, std::size_t to) {
    Star found;
    for (std::size_t i = from; i != to; i = i + 1 == star.link.size() ? 0 : i + 1) {
        found.link.push_back(star.link[i]);
        found.beyond.push_back(star.beyond[i]);
    }
    found.link.push_back(star.link[to]);
    found.beyond.push_back(nothing);
    return found;
}

}  // namespace

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
    patch.clear();
    Hole{points_.data(), star, guard_}.fill(patch);
}

// The edges of a star that are constraints, by their places in the link.
std::vector<std::size_t> Triangulation::marked_spokes(const Star& star, Vertex v) const {
    std::vector<std::size_t> found;
    if (!slots_.has_marks()) return found;
    for (std::size_t i = 0; i < star.link.size(); ++i)
        if (slots_.is_marked(previous(slots_.opposite(star.triangles[i], v)))) found.push_back(i);
    return found;
}

// Of a vertex on a constraint between two vertices of its link: on both sides, or with the ghost.
void Triangulation::plan_along(const Star& star, std::size_t from, std::size_t to,
                               Patch& patch) const {
    patch.clear();
    if (std::find(star.link.begin(), star.link.end(), ghost) != star.link.end()) {
        plan(star, patch);
    } else {
        for (const Star& side : {half(star, from, to), half(star, to, from)})
            Hole{points_.data(), side, guard_}.fill(patch);
    }
    const auto edge_between = [&](Vertex tail, Vertex head) {
        Edge e = 0;
        while (patch.vertices[next(e)] != tail || patch.vertices[previous(e)] != head) ++e;
        return e;
    };
    const Vertex a = star.link[from], b = star.link[to];
    patch.marked.push_back(edge_between(a, b));
    patch.join(patch.marked.back(), edge_between(b, a));
}

void Triangulation::replace(Vertex v, const Star& star, const Patch& patch,
                            std::vector<TriangleId>& made) {
    put(star.triangles, patch, made);
    forget(v);
}

void Triangulation::put(const std::vector<TriangleId>& gone, const Patch& patch,
                        std::vector<TriangleId>& made) {
    made.resize(patch.count());
    for (const TriangleId t : gone) slots_.drop(t);
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
    if (!slots_.has_marks()) return;
    for (const TriangleId t : made) slots_.set_marks(t, 0);
    for (Edge e = 0; e < patch.twins.size(); ++e)
        if (patch.twins[e] & Patch::outside) slots_.take_mark(named(e));
    for (const Edge e : patch.marked) slots_.mark(named(e));
}

void Triangulation::forget(Vertex v) {
    const Vertex last = order_[--size_];
    std::swap(order_[place_[v]], order_[size_]);
    std::swap(place_[v], place_[last]);
}

void Triangulation::remove(Vertex v) {
    if (!has_triangles()) return remove_from_line(v);
    find_star(v, removed_);
    if (leaves_a_line(removed_)) {
        lower(removed_);
        forget(v);
        return;
    }
    const std::vector<std::size_t> along = marked_spokes(removed_, v);
    if (along.empty()) {
        plan(removed_, patch_);
        return replace(v, removed_, patch_, star_triangles_);
    }
    plan_along(removed_, along[0], along[1], patch_);
    replace(v, removed_, patch_, star_triangles_);
    constraints_.unite(removed_.link[along[0]], v, removed_.link[along[1]]);
}

void Triangulation::remove_from_line(Vertex v) {
    const auto place = line_.find(points_[v]);
    const auto [a, b] = around(place);
    if (constraints_.has(piece(a, v))) constraints_.unite(a, v, b);
    line_.erase(place);
    forget(v);
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
