// Smoothing: points that were added, and that no constraint needs, move to better places.
//
// In an optimal Delaunay triangulation each point is at the mean of the centres of the circles
// around it, weighted by the areas of their triangles (L. Chen, "Mesh smoothing schemes based on
// optimal Delaunay triangulations", 2004), times the density where the mesh is to be finer. Here
// this is the power -3/2 of the area itself: so what was finer stays so. A point moves only if the
// smallest angle of the triangles that come is larger than that of those that go, and none of them
// would have to be split; else the same triangles come back.
//
// Points take turns in the order in which they were added, and stars begin at the first neighbour
// in the plane: so everything depends on positions alone.

#include "refinement/refinement.hpp"

namespace liftmesh::refinement {

// Ends early where no point moves any more.
Status Refinement::smooth() {
    const auto first = static_cast<Vertex>(rows_.size());
    const std::size_t count = mesh_.vertex_end() - first;
    bool is_moving = true;
    for (std::size_t round = 1; round <= wanted_.rounds && is_moving; ++round) {
        is_moving = false;
        for (Vertex v = first; v < mesh_.vertex_end(); ++v) {
            if (patience_.ends(256)) return Status::interrupted;
            if (v % 1024 == 0) tell(round, v - first, count);
            if (mesh_.is_present(v) && divided_[v] == no_piece) is_moving |= move(v);
        }
    }
    return Status::ok;
}

// False if it stays where it is.
bool Refinement::move(Vertex v) {
    find_star(v);
    const Point from = at(v), to = better_place(v);
    if (!std::isfinite(to.x) || !std::isfinite(to.y) || to == from) return false;
    const double before = sharpest(star_.triangles);
    take_out(v);
    Edge home = edge(fresh_around(from), 0);
    const Vertex tail = slots().tail(home), head = slots().head(home);
    const Place found = walk(home, to);
    if (!found.is_vertex && found.blocked == nothing) {
        if (is_better(to, found.triangle, before)) return true;
        find_star(v);
        take_out(v);
        home = mesh_.edge_between(tail, head);
    }
    mesh_.dig(from, triangle_of(home));
    put(from);
    return false;
}

// The triangle with a point among those in the place of its star. A walk to it might be blocked, as
// a constraint may end at the star.
TriangleId Refinement::fresh_around(Point p) const {
    const auto holds = [&](TriangleId t) {
        return !is_right_of(edge(t, 0), p) && !is_right_of(edge(t, 1), p) &&
               !is_right_of(edge(t, 2), p);
    };
    return *std::find_if(fresh_.begin(), fresh_.end(), holds);
}

void Refinement::find_star(Vertex v) {
    mesh_.find_star(v, star_);
    const auto& link = star_.link;
    const auto first = std::min_element(link.begin(), link.end(),
                                        [this](Vertex a, Vertex b) { return is_before(a, b); }) -
                       link.begin();
    const auto turn = [first](auto& all) {
        std::rotate(all.begin(), all.begin() + first, all.end());
    };
    turn(star_.triangles);
    turn(star_.beyond);
    turn(star_.link);
}

// Not finite where doubles do not tell.
Point Refinement::better_place(Vertex v) const {
    double whole = 0;
    Vector sum{0, 0};
    for (std::size_t i = 0; i < star_.link.size(); ++i) {
        const Vertex following = star_.link[i + 1 == star_.link.size() ? 0 : i + 1];
        const Vector a = between(v, star_.link[i]), b = between(v, following);
        const double twice_area = cross(a, b), weight = 1 / std::sqrt(twice_area);
        const double a2 = square(a), b2 = square(b), part = weight / 2 / twice_area;
        sum.x += part * (a2 * b.y - b2 * a.y);
        sum.y += part * (b2 * a.x - a2 * b.x);
        whole += weight;
    }
    return measures_.moved(at(v), {sum.x / whole, sum.y / whole});
}

// The greatest height of a centre over a base: the smaller the angle there, the higher it is.
double Refinement::sharpest(const std::vector<TriangleId>& triangles) const {
    double found = 0;
    for (const TriangleId t : triangles) found = std::max(found, shape(t).height);
    return found;
}

// Puts in a point that was taken out, whose star was as sharp as that.
bool Refinement::is_better(Point p, TriangleId conflict, double before) {
    constexpr double less = 1 - 0x1p-20;  // beyond all roundings
    const auto is_fresh = [this, time = time_](TriangleId t) { return stamp_[slot_of(t)] == time; };
    mesh_.dig(p, conflict);
    for (const TriangleId t : mesh_.cavity())
        if (!is_fresh(t)) before = std::max(before, shape(t).height);
    put(p);
    std::erase_if(fresh_, std::not_fn(is_fresh));
    fresh_.insert(fresh_.end(), mesh_.star().begin(), mesh_.star().end());
    unmeasured_.clear();
    for (const TriangleId t : fresh_)
        if (!(shape(t).height < less * before) || !is_fine(t)) return false;
    return unmeasured_.empty() || too_long().empty();
}

// Whether neither the triangle nor a constraint at its sides is to be split, or could be if digits
// sufficed.
bool Refinement::is_fine(TriangleId t) {
    if (need(t) || is_tiny(shape(t).base)) return false;
    for (unsigned k = 0; k < 3; ++k) {
        const Edge e = edge(t, k);
        if (!slots().is_marked(e)) continue;
        if (is_encroached_by_apex(e)) return false;
        if (wanted_.is_conforming && !is_delaunay_across(e)) return false;
    }
    return true;
}

}  // namespace liftmesh::refinement
