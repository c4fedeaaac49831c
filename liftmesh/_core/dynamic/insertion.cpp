// Insertion: the cavity of the triangles that conflict with a point, ghosts among them, and the
// star of the point in their stead.

#include "base/buffer.hpp"
#include "dynamic/triangulation.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh::dynamic {

// No vertex is inside the cavity, so its triangles are a tree: a walk that crosses edges
// counter-clockwise meets each once, and the border in order.
void Triangulation::dig(Point p, TriangleId conflict, Edge split) {
    cavity_.assign(1, conflict);
    border_.clear();
    stack_.clear();
    const bool has_marks = slots_.has_marks();
    const auto push = [this](Edge e) {
        slots_.prefetch(triangle_of(slots_.twin(e)));
        stack_.push_back(e);
    };
    for (unsigned k = 3; k-- > 0;) push(edge(conflict, k));
    while (!stack_.empty()) {
        const Edge e = stack_.back(), beyond = slots_.twin(e);
        stack_.pop_back();
        if ((has_marks && slots_.is_marked(e) && e != split) ||
            !conflicts(triangle_of(beyond), p)) {
            border_.push_back({slots_.tail(e), slots_.head(e), beyond});
            continue;
        }
        cavity_.push_back(triangle_of(beyond));
        push(previous(beyond));
        push(next(beyond));
    }
}

void Triangulation::prefetch_around(TriangleId t) const {
    if (slots_.is_free(t)) return;
    for (unsigned k = 0; k < 3; ++k) {
        const Vertex v = slots_.vertex(t, k);
        if (v != ghost) liftmesh::prefetch(points_.data() + v);
        slots_.prefetch(triangle_of(slots_.twin(edge(t, k))));
    }
}

Vertex Triangulation::fill(Point p) {
    slots_.reserve(border_.size() - cavity_.size());  // beside those of the cavity
    star_triangles_.reserve(border_.size());
    const Vertex v = add_vertex(p);
    for (const TriangleId t : cavity_) slots_.drop(t);
    connect_star(v);
    return v;
}

void Triangulation::connect_star(Vertex v) {
    star_triangles_.clear();
    for (const BorderEdge& each : border_) {
        const TriangleId t = slots_.make(each.tail, each.head, v);
        star_triangles_.push_back(t);
        slots_.join(slots_.opposite(t, v), each.beyond);
        if (each.tail != ghost) corner_[each.tail] = slots_.opposite(t, each.tail);
    }
    for (std::size_t i = 0; i < border_.size(); ++i) {
        const std::size_t following = i + 1 == border_.size() ? 0 : i + 1;
        slots_.join(slots_.opposite(star_triangles_[i], border_[i].tail),
                    slots_.opposite(star_triangles_[following], border_[following].head));
    }
    corner_[v] = slots_.opposite(star_triangles_[0], v);
    if (!slots_.has_marks()) return;
    for (const TriangleId t : star_triangles_) {
        slots_.set_marks(t, 0);
        slots_.take_mark(slots_.opposite(t, v));
    }
}

Vertex Triangulation::insert(Point p, Vertex hint) {
    if (!has_triangles()) return insert_on_line(p);
    if (!is_present(hint) && hints_.are_due(size_)) make_hints();
    const Place place = locate(p, hint);
    if (place.vertex != ghost) return last_ = place.vertex;
    const Edge split = constraint_at(p, place.triangle);
    dig(p, place.triangle, split);
    return last_ = split == nothing ? fill(p) : fill(p, split);
}

// The constraint on which a point lies, of those around its triangle, if any.
Edge Triangulation::constraint_at(Point p, TriangleId t) const {
    if (constraints_.empty() || slots_.is_ghost(t)) return nothing;
    for (unsigned k = 0; k < 3; ++k) {
        const Edge e = edge(t, k);
        if (slots_.is_marked(e) &&
            orient2d(points_[slots_.tail(e)], points_[slots_.head(e)], p) == 0)
            return e;
    }
    return nothing;
}

// On a constraint, which the new vertex splits.
Vertex Triangulation::fill(Point p, Edge split) {
    const Vertex a = slots_.tail(split), b = slots_.head(split);
    const Vertex v = size_ == points_.size() ? static_cast<Vertex>(size_) : order_[size_];
    constraints_.split(piece(a, b), v);
    try {
        fill(p);
    } catch (...) {
        constraints_.unite(a, v, b);
        throw;
    }
    for (std::size_t i = 0; i < border_.size(); ++i)
        if (border_[i].tail == a || border_[i].tail == b)
            slots_.mark(slots_.opposite(star_triangles_[i], border_[i].head));
    return v;
}

// Whether a point is off the line of the others.
bool Triangulation::is_off_line(Line::const_iterator place) const {
    if (line_.size() < 3) return false;
    auto first = line_.begin(), last = std::prev(line_.end());
    if (first == place) ++first;
    if (last == place) --last;
    return orient2d(first->first, last->first, place->first) != 0;
}

Vertex Triangulation::insert_on_line(Point p) {
    const auto [place, is_new] = line_.try_emplace(p, ghost);
    if (!is_new) return place->second;
    const bool is_off = is_off_line(place);
    try {
        const Vertex v = add_vertex(p);
        place->second = v;
        if (is_off)
            raise(v);
        else if (const auto [a, b] = around(place); constraints_.has(piece(a, b)))
            constraints_.split(piece(a, b), v);
        return last_ = v;
    } catch (...) {
        if (place->second != ghost) forget(place->second);
        line_.erase(place);
        throw;
    }
}

// The neighbours on the line, or the ghost.
std::pair<Vertex, Vertex> Triangulation::around(Line::const_iterator place) const {
    const auto after = std::next(place);
    return {place == line_.begin() ? ghost : std::prev(place)->second,
            after == line_.end() ? ghost : after->second};
}

// From points on a line and one off it to a fan of triangles.
void Triangulation::raise(Vertex apex) {
    hull_.clear();
    for (const auto& [p, v] : line_)
        if (v != apex) hull_.push_back(v);
    if (orient2d(points_[hull_.front()], points_[hull_.back()], points_[apex]) < 0)
        std::reverse(hull_.begin(), hull_.end());
    slots_.reserve(2 * hull_.size());
    if (!constraints_.empty()) slots_.keep_marks();
    hull_.push_back(apex);
    line_.clear();
    Edge side = nothing;  // from the last vertex to the apex
    for (std::size_t i = 0; i + 2 < hull_.size(); ++i) {
        const TriangleId t = slots_.make(hull_[i], hull_[i + 1], apex);
        if (constraints_.has(piece(hull_[i], hull_[i + 1]))) slots_.set_marks(t, 1 << 2);
        if (i == 0) corner_[apex] = edge(t, 1);
        if (i != 0) slots_.join(side, edge(t, 1));
        corner_[hull_[i]] = edge(t, 2);
        corner_[hull_[i + 1]] = side = edge(t, 0);
    }
    place_ghosts();
}

// Those of hull_, counter-clockwise. In the place of the corner of a vertex is the edge from it to
// the next one.
void Triangulation::place_ghosts() {
    TriangleId first = nothing, last = nothing;
    for (std::size_t i = 0; i < hull_.size(); ++i) {
        const Vertex tail = hull_[i], head = hull_[i + 1 == hull_.size() ? 0 : i + 1];
        const TriangleId g = slots_.make(head, tail, ghost);
        slots_.join(corner_[tail], edge(g, 2));
        slots_.take_mark(edge(g, 2));
        corner_[tail] = next(corner_[tail]);
        if (i == 0) first = g;
        if (i != 0) slots_.join(edge(last, 1), edge(g, 0));
        last = g;
    }
    slots_.join(edge(last, 1), edge(first, 0));
}

Vertex Triangulation::add_vertex(Point p) {
    if (size_ == points_.size()) {
        const auto last = static_cast<Vertex>(size_);
        reserve(1);
        points_.push_back(p);
        corner_.push_back(nothing);
        order_.push_back(last);
        place_.push_back(last);
    }
    const Vertex v = order_[size_++];
    points_[v] = p;
    hints_.note(p, v);
    range_.add(p);
    const Scale scale(range_);
    if (scale.moves || !scale.guard.vouches()) guard_ = Guard::anywhere();
    return v;
}

}  // namespace liftmesh::dynamic
