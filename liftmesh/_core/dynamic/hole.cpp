#include "dynamic/hole.hpp"

#include <vector>

#include "predicates/orient2d.hpp"

namespace liftmesh::dynamic {

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

namespace {

class NoInterrupt final : public Interrupt {
 public:
    bool requested() override { return false; }
};

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

}  // namespace

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

}  // namespace liftmesh::dynamic
