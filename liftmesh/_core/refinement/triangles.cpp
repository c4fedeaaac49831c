// Finds triangles that are sharp or large, and places points in them.

#include "refinement/refinement.hpp"

namespace liftmesh::refinement {

// Of sides opposite to the corners of a triangle, the shortest one; of several the first by apex.
Edge Refinement::shortest(TriangleId t, const std::array<double, 3>& length2) const {
    const auto apex = [&](unsigned k) { return at(slots().vertex(t, k)); };
    unsigned base = 0;
    for (unsigned k = 1; k < 3; ++k)
        if (length2[k] < length2[base] ||
            (length2[k] == length2[base] && before_xy(apex(k), apex(base))))
            base = k;
    return edge(t, base);
}

Shape Refinement::shape(TriangleId t) const {
    std::array<Vector, 3> corners, side;  // sides are opposite to the corners
    std::array<double, 3> length2;
    for (unsigned k = 0; k < 3; ++k) corners[k] = measures_.scaled(at(slots().vertex(t, k)));
    for (unsigned k = 0; k < 3; ++k) {
        side[k] = corners[(k + 2) % 3] - corners[(k + 1) % 3];
        length2[k] = square(side[k]);
    }
    const Edge shortest_one = shortest(t, length2);
    const unsigned base = shortest_one - t;
    const Vector onward = side[(base + 1) % 3], back = side[(base + 2) % 3];
    const Corner corner(onward, {-back.x, -back.y});
    const double area = cross(onward, back);
    return {shortest_one, length2[base],           std::max({length2[0], length2[1], length2[2]}),
            area,         corner.dot() / 2 / area, corner.is_less(sharp_)};
}

// Whether the triangle over a base cannot be helped: its ends are as far from the corner of the two
// pieces that they divide, which meet in a small angle.
bool Refinement::is_between_constraints(Edge base) const {
    const Vertex a = slots().tail(base), b = slots().head(base);
    if (divided_[a] < 0 || divided_[b] < 0 || divided_[a] == divided_[b]) return false;
    const Vertex corner = corner_of(divided_[a], divided_[b]);
    if (corner == ghost) return false;
    const Vector along_one = between(corner, a), along_other = between(corner, b);
    if (!Corner(along_one, along_other).is_less(of_sixty_degrees2)) return false;
    const double to_a = square(along_one), to_b = square(along_other);
    return to_a < 1.001 * to_b && to_b < 1.001 * to_a;
}

// Whether the pieces themselves meet in a small angle: rows on them may be rounded to elsewhere.
bool Refinement::is_blamed(Edge base) const {
    if (!is_between_constraints(base)) return false;
    const std::int32_t one = divided_[slots().tail(base)], other = divided_[slots().head(base)];
    const Vertex corner = corner_of(one, other);
    const auto along = [&](std::int32_t piece) {
        const constrained::Piece& its = pieces_[static_cast<std::size_t>(piece)];
        const Vertex first = vertex_of(its.first);
        return between(corner, first == corner ? vertex_of(its.second) : first);
    };
    return Corner(along(one), along(other)).is_less(of_sixty_degrees2);
}

// Whether points are so near to each other that a new one beside them would be rounded too far.
bool Refinement::is_tiny(Point a, Point b, double ulps) const {
    const double least = measures_.scaled(ulps * std::max(ulp_at(a), ulp_at(b)));
    return square(measures_.between(a, b)) < least * least;
}

// Where two pieces meet, or the ghost.
Vertex Refinement::corner_of(std::int32_t piece, std::int32_t another) const {
    const constrained::Piece& one = pieces_[static_cast<std::size_t>(piece)];
    const constrained::Piece& other = pieces_[static_cast<std::size_t>(another)];
    for (const Row end : {one.first, one.second}) {
        if (end != other.first && end != other.second) continue;
        return vertex_of(end);
    }
    return ghost;
}

// What is to be split. Lengths are measured later, of many triangles at once.
std::optional<Waiting> Refinement::need(TriangleId t) {
    if (!is_inside(t)) return {};
    const Shape found = shape(t);
    const Edge base = found.base;
    const Waiting named{found.base2, base, stamp_[slot_of(t)]};
    if ((found.is_sharp && !is_left(base)) || has_large_area(t, found)) return named;
    if (wanted_.lengths) unmeasured_.push_back(named);
    return {};
}

bool Refinement::has_large_area(TriangleId t, const Shape& its) {
    return !largest_.empty() && its.twice_area / 2 > largest_[static_cast<std::size_t>(region(t))];
}

// The sides of a triangle, from that of an edge on, times a power of two, which makes them about
// one, and its exponent. What is very small beside the domain is not split, as its squares are
// lost; but by these it is listed.
std::pair<std::array<Vector, 3>, int> Refinement::sides_near_one(Edge first) const {
    const auto scale = [](auto& vectors) {
        double most = std::numeric_limits<double>::min();
        for (const auto& each : vectors)
            most = std::max({most, std::abs(each.x), std::abs(each.y)});
        const int exponent = -std::ilogb(most);
        for (auto& each : vectors)
            each = {std::ldexp(each.x, exponent), std::ldexp(each.y, exponent)};
        return exponent;
    };
    std::array corner{at(slots().tail(first)), at(slots().head(first)), at(slots().apex(first))};
    int exponent = scale(corner);
    std::array<Vector, 3> side;
    for (std::size_t k = 0; k < 3; ++k) {
        const Point from = corner[k], to = corner[(k + 1) % 3];
        side[k] = {to.x - from.x, to.y - from.y};
    }
    exponent += scale(side);
    return {side, exponent};
}

// Also of a triangle whose squares are lost.
Edge Refinement::surely_shortest(TriangleId t) const {
    const auto side = sides_near_one(edge(t, 0)).first;
    return shortest(t, {square(side[0]), square(side[1]), square(side[2])});
}

bool Refinement::is_listed_for_area(Edge base) {
    if (wanted_.largest.empty()) return false;
    const auto [side, exponent] = sides_near_one(base);
    const double most = wanted_.largest[static_cast<std::size_t>(region(triangle_of(base)))];
    return cross(side[1], side[2]) / 2 > std::ldexp(most, 2 * exponent);
}

bool Refinement::is_listed_for_length(Edge base, double length) const {
    const auto [side, exponent] = sides_near_one(base);
    const double most = std::numbers::sqrt2 * std::ldexp(length, exponent);
    return std::ranges::any_of(side, [=](Vector each) { return square(each) > most * most; });
}

void Refinement::look_at(TriangleId t) {
    if (const auto found = need(t)) waiting_.push(*found);
}

bool Refinement::is_gone(const Waiting& waiting) const {
    const TriangleId t = triangle_of(waiting.base);
    return slots().is_free(t) || stamp_[slot_of(t)] != waiting.stamp;
}

// Asks for the lengths that are wanted in all triangles that are new, and returns those too long.
std::vector<Waiting> Refinement::too_long(bool at_end) {
    std::erase_if(unmeasured_, [this](const Waiting& each) { return is_gone(each); });
    std::vector<Point> centroids;
    std::vector<std::int32_t> regions;
    std::vector<double> lengths(unmeasured_.size());
    for (const Waiting& each : unmeasured_) {
        const Point p = at(slots().tail(each.base)), q = at(slots().head(each.base)),
                    r = at(slots().apex(each.base));
        centroids.push_back({p.x / 3 + q.x / 3 + r.x / 3, p.y / 3 + q.y / 3 + r.y / 3});
        regions.push_back(region(triangle_of(each.base)));
    }
    wanted_.lengths(centroids, regions, lengths.data());
    std::vector<Waiting> long_ones;
    expected_ = static_cast<double>(made_);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const Edge base = unmeasured_[i].base;
        const Shape found = shape(triangle_of(base));
        const double most = std::numbers::sqrt2 * measures_.scaled(lengths[i]);
        if (!(at_end ? is_listed_for_length(base, lengths[i]) : found.longest2 > most * most))
            continue;
        long_ones.push_back(unmeasured_[i]);
        expect(found.twice_area / 2, 0.25 * most * most);
    }
    unmeasured_.clear();
    return long_ones;
}

// The centre of the circle, or a place nearer to the base.
Point Refinement::center(const Shape& shape) const {
    return center(shape, std::min(shape.height, off_center_));
}

Point Refinement::center(const Shape& shape, double height) const {
    const Vertex a = slots().tail(shape.base), b = slots().head(shape.base);
    const Vector base = between(a, b);
    return measures_.moved(at(a), {base.x / 2 - base.y * height, base.y / 2 + base.x * height});
}

// False where no longer side is a constraint that can be split.
bool Refinement::split_long_side(Edge base) {
    Edge one = next(base), other = previous(base);
    const auto length2 = [this](Edge e) { return square(side_of(e)); };
    if (length2(one) < length2(other)) std::swap(one, other);
    return (slots().is_marked(one) && ask_to_split(one)) ||
           (slots().is_marked(other) && ask_to_split(other));
}

void Refinement::treat(const Waiting& waiting) {
    if (is_gone(waiting)) return;
    if (!may_add()) {
        is_capped_ = true;
        return;
    }
    const Shape its = shape(triangle_of(waiting.base));
    const bool is_large = its.is_sharp && is_left(its.base);  // else it would not wait
    if (is_large && split_long_side(its.base)) return waiting_.push(waiting);
    if (is_large && is_tiny(its.base)) return;
    const Point p = is_large ? center(its, its.height) : center(its);
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
    const Place found = walk(waiting.base, p);
    if (found.is_vertex) return;
    in_the_way_.clear();
    if (found.blocked != nothing) {
        in_the_way_.push_back(found.blocked);
    } else {
        mesh_.dig(p, found.triangle);
        for (const BorderEdge& each : mesh_.border())
            if (slots().is_marked(each.beyond) && is_encroached(each.beyond, p))
                in_the_way_.push_back(each.beyond);
    }
    if (in_the_way_.empty()) return add(p);
    bool is_asked = false;
    for (const Edge e : in_the_way_) is_asked |= ask_to_split(e);
    if (is_asked) waiting_.push(waiting);
}

bool Refinement::is_marked_at(Edge e, Point p) const {
    return slots().is_marked(e) && orient2d(at(slots().tail(e)), at(slots().head(e)), p) == 0;
}

// From a triangle to a point, up to a constraint. The way depends on positions alone.
Refinement::Place Refinement::walk(Edge base, Point p) const {
    Edge tried[3] = {base, next(base), previous(base)};
    unsigned first = 0;
    while (true) {
        Edge crossed = nothing;
        for (unsigned k = first; k < 3 && crossed == nothing; ++k)
            if (is_right_of(tried[k], p)) crossed = tried[k];
        const TriangleId t = triangle_of(tried[0]);
        if (crossed == nothing) {
            for (const Edge e : tried) {
                if (at(slots().apex(e)) == p) return {t, nothing, true};
                if (is_marked_at(e, p)) return {t, e};
            }
            return {t};
        }
        if (slots().is_marked(crossed)) return {t, crossed};
        const Edge from = slots().twin(crossed);
        tried[0] = from;
        tried[1] = next(from);
        tried[2] = previous(from);
        first = 1;
    }
}

void Refinement::add(Point p) {
    put(p);
    ++made_;
    look_around();
}

// In the cavity, inside one region.
void Refinement::put(Point p) {
    const std::int32_t inside = region(mesh_.cavity()[0]);
    fill(p, no_piece);
    for (const TriangleId t : mesh_.star()) region(t) = inside;
}

Vertex Refinement::fill(Point p, std::int32_t piece) {
    const Vertex v = mesh_.fill(p);
    if (v >= divided_.size()) divided_.resize(v + std::size_t{1});
    divided_[v] = piece;
    region_.resize(slot_of(slots().end()), outside);
    stamp(mesh_.star());
    return v;
}

void Refinement::stamp(const std::vector<TriangleId>& triangles) {
    stamp_.resize(slot_of(slots().end()));
    ++time_;
    for (const TriangleId t : triangles) stamp_[slot_of(t)] = time_;
}

// The triangles around the last point, from the border's first one in the plane on.
void Refinement::look_around() {
    const auto& border = mesh_.border();
    std::size_t first = 0;
    for (std::size_t i = 1; i < border.size(); ++i)
        if (is_before(border[i].tail, border[first].tail)) first = i;
    for (std::size_t step = 0; step < border.size(); ++step) {
        const std::size_t i = (first + step) % border.size();
        const TriangleId t = mesh_.star()[i];
        if (slots().is_ghost(t)) continue;
        look_at_side(slots().twin(border[i].beyond));
        look_at(t);
    }
}

}  // namespace liftmesh::refinement
