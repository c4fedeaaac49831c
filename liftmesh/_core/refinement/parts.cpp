// Splits constraints to which points come too near.

#include "refinement/refinement.hpp"

namespace liftmesh::refinement {

// Whether a point is so near to a constraint that this is to be split.
bool Refinement::is_encroached(Edge e, Point p) const {
    const auto to = [&](Vertex v) { return measures_.between(p, at(v)); };
    return Corner(to(slots().tail(e)), to(slots().head(e))).is_wide(wide_);
}

// A side of a triangle, seen from inside.
void Refinement::look_at_side(Edge e) {
    if (!slots().is_marked(e) || !counts(triangle_of(e))) return;
    if (is_encroached_by_apex(e)) ask_to_split(e);
}

// False if it cannot be split.
bool Refinement::ask_to_split(Edge e) {
    Vertex a = slots().tail(e), b = slots().head(e);
    if (before_xy(at(b), at(a))) std::swap(a, b);
    const Part part{square(between(a, b)), a, b};
    if (is_tiny(e) || (!stuck_.empty() && stuck_.contains(key(part)))) return false;
    parts_.push(part);
    return true;
}

// Whether another constraint ends at the tail of an edge, in a small angle inside; `beside` is that
// edge of the triangle on its left which ends there, or starts on its right.
bool Refinement::is_narrow(Edge e, Edge beside) const {
    if (!counts(triangle_of(beside)) || !slots().is_marked(beside)) return false;
    const Vertex corner = slots().tail(e);
    const Vertex other =
        slots().tail(beside) == corner ? slots().head(beside) : slots().tail(beside);
    return Corner(between(corner, slots().head(e)), between(corner, other))
        .is_less(of_sixty_degrees2);
}

// At the tail of an edge.
bool Refinement::has_narrow_corner(Edge e) const {
    return is_narrow(e, previous(e)) || is_narrow(e, next(slots().twin(e)));
}

Point Refinement::place(const Part& part, Edge e) const {
    for (const Edge side : {e, slots().twin(e)})
        if (const auto found = place_across(part, side)) return *found;
    const bool at_first = has_narrow_corner(e), at_second = has_narrow_corner(slots().twin(e));
    const Point a = at(part.first), b = at(part.second);
    if (at_first == at_second) return middle(a, b);
    return at_first ? at_shell(a, b, measures_) : at_shell(b, a, measures_);
}

// Where the apex is on another piece, and the two meet in a small angle: as far from there as it. A
// place nearer to an end than half the way across would make shorter and shorter parts.
std::optional<Point> Refinement::place_across(const Part& part, Edge side) const {
    const Vertex v = slots().apex(side);
    if (!counts(triangle_of(side)) || !is_encroached_by_apex(side)) return {};
    const std::int32_t piece = piece_at(part.first, part.second);
    if (const Point foot = on_piece(piece, at(v)); is_tiny(at(v), foot)) return foot;
    double nearest = std::numeric_limits<double>::infinity();
    std::optional<Point> found;
    for (const std::int32_t other : pieces_of(v)) {
        const Vertex corner = other == piece ? ghost : corner_of(piece, other);
        if (corner == ghost || corner == v) continue;
        const auto [from, to] = ends_from(part, corner);
        if (!Corner(between(corner, to), between(corner, v)).is_less(of_sixty_degrees2)) continue;
        const double distance = length(between(corner, v));
        const double before = distance - length(between(corner, from));
        const double after = length(between(corner, to)) - distance;
        if (!(before > 0 && after > 0 && distance <= nearest)) continue;
        const Point p = along(at(from), at(to), before / (before + after));
        if (found && distance == nearest && before_xy(*found, p)) continue;
        if (2 * std::min(before, after) < length(measures_.between(at(v), p))) continue;
        nearest = distance;
        found = p;
    }
    return found;
}

// The ends of a part, the one nearer to a corner of its piece first.
std::pair<Vertex, Vertex> Refinement::ends_from(const Part& part, Vertex corner) const {
    const bool is_first =
        square(between(corner, part.first)) < square(between(corner, part.second));
    return is_first ? std::pair(part.first, part.second) : std::pair(part.second, part.first);
}

// The pieces that a vertex is on; none of one with many neighbours.
std::vector<std::int32_t> Refinement::pieces_of(Vertex v) const {
    constexpr std::size_t many = 64;
    if (divided_[v] == no_piece) return {};
    if (divided_[v] != given) return {divided_[v]};
    std::vector<std::int32_t> found;
    Edge e = mesh_.edge_from(v);
    for (std::size_t i = 0; i < many; ++i) {
        if (slots().is_marked(e)) found.push_back(piece_at(v, slots().head(e)));
        e = mesh_.turned(e);
        if (e == mesh_.edge_from(v)) return found;
    }
    return {};
}

// The piece that a part belongs to.
std::int32_t Refinement::piece_at(Vertex a, Vertex b) const {
    for (const Vertex v : {a, b})
        if (divided_[v] >= 0) return divided_[v];
    const auto [first, second] = std::minmax({rows_[a], rows_[b]});
    const auto found =
        std::lower_bound(pieces_.begin(), pieces_.end(), constrained::Piece{first, second});
    return static_cast<std::int32_t>(found - pieces_.begin());
}

void Refinement::split(const Part& part) {
    Edge e = mesh_.edge_between(part.first, part.second);
    if (e == nothing || !slots().is_marked(e)) return;
    if (!may_add()) {
        is_capped_ = true;
        return;
    }
    if (!wanted_.is_conforming) {
        clear_circle(part);
        e = mesh_.edge_between(part.first, part.second);
    }
    insert_on(part, e, on_piece(piece_at(part.first, part.second), place(part, e)));
}

// The nearest place on a piece: so rounding does not add up from split to split.
Point Refinement::on_piece(std::int32_t piece, Point p) const {
    const constrained::Piece& its = pieces_[static_cast<std::size_t>(piece)];
    Point a = at(vertex_of(its.first)), b = at(vertex_of(its.second));
    if (before_xy(b, a)) std::swap(a, b);
    const Vector whole = measures_.between(a, b);
    return along(a, b, dot(measures_.between(a, p), whole) / square(whole));
}

// Takes out points that were added, and that no constraint needs, near to one that is to be split.
void Refinement::clear_circle(const Part& part) {
    const auto side = [&] { return mesh_.edge_between(part.first, part.second); };
    if (has_narrow_corner(side()) || has_narrow_corner(slots().twin(side()))) return;
    while (remove_apex(side())) {
    }
    while (remove_apex(slots().twin(side()))) {
    }
}

bool Refinement::remove_apex(Edge e) {
    const TriangleId t = triangle_of(e);
    if (!is_inside(t)) return false;
    const Vertex v = slots().apex(e);
    if (divided_[v] != no_piece) return false;
    if (dot(between(v, slots().tail(e)), between(v, slots().head(e))) >= 0) return false;
    mesh_.find_star(v, star_);
    take_out(v);
    ++removed_;
    in_order(fresh_);
    for (const TriangleId each : fresh_) {
        for (unsigned k = 0; k < 3; ++k) look_at_side(edge(each, k));
        look_at(each);
    }
    return true;
}

// One inside a region, whose star has been found.
void Refinement::take_out(Vertex v) {
    const std::int32_t inside = region(star_.triangles[0]);
    mesh_.plan(star_, patch_);
    mesh_.replace(v, star_, patch_, fresh_);
    for (const TriangleId t : fresh_) region(t) = inside;
    stamp(fresh_);
}

// Whether the star of a point that divides a part would be a triangulation, and Delaunay but for
// the part: it is off the line as far as it was rounded.
bool Refinement::fits(const Part& part, Point p) const {
    const auto& border = mesh_.border();
    bool has_first = false, has_second = false;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const auto [tail, head, beyond] = border[i];
        has_first |= tail == part.first;
        has_second |= tail == part.second;
        if (tail == ghost || head == ghost) continue;
        if (orient2d(at(tail), at(head), p) <= 0) return false;
        const Vertex further = border[i + 1 == border.size() ? 0 : i + 1].head;
        if (head == part.first || head == part.second || further == ghost) continue;
        if (incircle_canonical(at(tail), at(head), p, at(further), Guard::anywhere())) return false;
    }
    return has_first && has_second;
}

// The triangle that a point beside the middle of an edge is in, which may be a ghost; or `nothing`
// if that is behind a constraint, or far.
TriangleId Refinement::find_beside(Edge e, Point p) const {
    constexpr unsigned far = 1000;  // along a fan of slivers
    if (slots().is_ghost(triangle_of(e))) e = slots().twin(e);
    for (unsigned step = 0; step < far; ++step) {
        const TriangleId t = triangle_of(e);
        if (slots().is_ghost(t)) return t;
        Edge crossed = nothing;
        bool is_in = true;
        for (const Edge side : {e, next(e), previous(e)}) {
            if (!is_right_of(side, p)) continue;
            is_in = false;
            if (crossed == nothing && !slots().is_marked(side)) crossed = side;
        }
        if (is_in) return t;
        if (crossed == nothing) break;
        e = slots().twin(crossed);
    }
    return nothing;
}

// Whether the triangle of an edge is in the cavity.
bool Refinement::is_dug(Edge e) const {
    const auto& cavity = mesh_.cavity();
    return std::find(cavity.begin(), cavity.end(), triangle_of(e)) != cavity.end();
}

// Digs the cavity of a point that divides a part; false if it was rounded so far from it that it is
// beyond an end in x or y, or cannot see both.
bool Refinement::dig_across(const Part& part, Edge e, Point p) {
    const Point a = at(part.first), b = at(part.second);
    const auto is_between = [](double x, double from, double to) {
        return std::min(from, to) <= x && x <= std::max(from, to);
    };
    if (p == a || p == b || !is_between(p.x, a.x, b.x) || !is_between(p.y, a.y, b.y)) return false;
    mesh_.unmark(e);
    const TriangleId t = find_beside(e, p);
    if (t != nothing) mesh_.dig(p, t);
    if (t != nothing && (is_dug(e) || is_dug(slots().twin(e))) && fits(part, p)) return true;
    mesh_.mark(e);
    return false;
}

void Refinement::insert_on(const Part& part, Edge e, Point middle) {
    constexpr std::size_t places = 9;
    const std::int32_t left = region(triangle_of(e)), right = region(triangle_of(slots().twin(e)));
    for (std::size_t i = 0; i < places; ++i) {
        const Point p = beside(middle, i);
        if (!dig_across(part, e, p)) continue;
        const Vertex v = fill(p, piece_at(part.first, part.second));
        ++made_;
        divide(part, left, right);
        look_around();
        for (const Vertex end : {part.first, part.second}) {
            const Edge half = mesh_.edge_between(end, v);
            look_at_side(half);
            look_at_side(slots().twin(half));
        }
        return;
    }
    stuck_.insert(key(part));
}

// The star of a new vertex between the ends of a part: triangles on the left side of the part get
// one region, those on the right side the other.
void Refinement::divide(const Part& part, std::int32_t left, std::int32_t right) {
    const auto& border = mesh_.border();
    std::size_t i = 0;
    while (border[i].tail != part.second) ++i;
    std::int32_t inside = left;
    for (std::size_t step = 0; step < border.size(); ++step, i = (i + 1) % border.size()) {
        const TriangleId t = mesh_.star()[i];
        if (border[i].tail == part.first) inside = right;
        if (border[i].tail == part.first || border[i].tail == part.second)
            mesh_.mark(slots().opposite(t, border[i].head));
        region(t) = slots().is_ghost(t) ? outside : inside;
    }
}

// Whether all constraints are in the triangulation without constraints; else some are to be split.
bool Refinement::conforms() {
    bool all = true;
    for (TriangleId t = 0; t < slots().end(); t += words_per_triangle) {
        if (slots().is_free(t) || slots().is_ghost(t)) continue;
        for (unsigned k = 0; k < 3; ++k) {
            const Edge e = edge(t, k), f = slots().twin(e);
            if (!slots().is_marked(e) || f < e || is_delaunay_across(e)) continue;
            if (!has_tiny_side(e) && !has_tiny_side(f)) all &= !ask_to_split(e);
        }
    }
    return all;
}

bool Refinement::is_delaunay_across(Edge e) const {
    const Vertex beyond = slots().apex(slots().twin(e));
    return beyond == ghost ||
           !incircle_canonical(at(slots().tail(e)), at(slots().head(e)), at(slots().apex(e)),
                               at(beyond), Guard::anywhere());
}

}  // namespace liftmesh::refinement
