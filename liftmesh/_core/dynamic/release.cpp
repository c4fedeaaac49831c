#include "dynamic/release.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh::dynamic {

bool Release::conflicts(TriangleId t, Vertex v) const {
    return incircle_canonical(point(slots_.vertex(t, 0)), point(slots_.vertex(t, 1)),
                              point(slots_.vertex(t, 2)), point(v), guard_);
}

// Whether a vertex is ahead of the strip's last edge.
bool Release::is_valid(Vertex c) const {
    return orient2d(point(right_.at), point(c), point(left_.at)) > 0;
}

void Release::pass(Side& side) {
    const Edge beyond = slots_.twin(rim(side));
    side.corner = side.is_left ? next(beyond) : previous(beyond);
    gone_->push_back(triangle_of(beyond));
}

// Whether there were any.
bool Release::pass_conflicts(Side& side, Vertex other) {
    bool is_any = false;
    while (true) {
        const Edge e = rim(side);
        const TriangleId beyond = triangle_of(slots_.twin(e));
        if (slots_.is_marked(e) || slots_.is_ghost(beyond) || !conflicts(beyond, other))
            return is_any;
        pass(side);
        is_any = true;
    }
}

// To the vertex ahead. Its neighbours behind the strip's new edge are passed.
void Release::move_ahead(Side& side, Vertex other) {
    side.at = ahead(side);
    side.corner = side.is_left ? previous(side.corner) : next(side.corner);
    const int behind = side.is_left ? 1 : -1;
    while (orient2d(point(side.at), point(ahead(side)), point(other)) == behind) pass(side);
}

// The triangle at the end from which the edge comes.
void Release::begin(Edge e) {
    left_.corner = next(e);
    right_.corner = previous(slots_.twin(e));
    for (bool passed = true; passed;) {
        passed = pass_conflicts(left_, ahead(right_));
        passed |= pass_conflicts(right_, ahead(left_));
    }
    const Edge t = patch_->add(slots_.tail(e), ahead(right_), ahead(left_));
    rims_.push_back({rim(left_), t + 1});
    rims_.push_back({rim(right_), t + 2});
    last_ = t;
    const Vertex l = ahead(left_), r = ahead(right_);
    move_ahead(left_, r);
    move_ahead(right_, l);
}

// By a triangle; false if it is the last.
bool Release::extend() {
    bool is_left = is_valid(ahead(left_)), is_right = is_valid(ahead(right_));
    if (is_left) pass_conflicts(left_, right_.at);
    if (is_right) pass_conflicts(right_, left_.at);
    const Vertex l = ahead(left_), r = ahead(right_);
    const bool is_end = l == r;
    if (is_left && is_right && !is_end)
        is_left =
            !incircle_canonical(point(right_.at), point(l), point(left_.at), point(r), guard_);
    const Edge t = patch_->add(right_.at, is_left ? l : r, left_.at);
    patch_->join(t + 1, last_);
    if (is_left || is_end) rims_.push_back({rim(left_), t});
    if (!is_left || is_end) rims_.push_back({rim(right_), t + 2});
    if (is_end) return false;
    last_ = is_left ? t + 2 : t;
    if (is_left)
        move_ahead(left_, right_.at);
    else
        move_ahead(right_, left_.at);
    return true;
}

// To the triangles that stay; or, where a side is the other face of another, to the new one there.
void Release::join(Patch& patch) {
    std::sort(rims_.begin(), rims_.end());
    for (const Rim& each : rims_) {
        const Edge beyond = slots_.twin(each.old);
        const auto other = std::lower_bound(rims_.begin(), rims_.end(), Rim{beyond, 0});
        if (other == rims_.end() || other->old != beyond) {
            patch.join(each.local, beyond | Patch::outside);
            continue;
        }
        patch.join(each.local, other->local);
        if (slots_.is_marked(each.old)) patch.marked.push_back(each.local);
    }
}

void Release::plan(Edge e, std::vector<TriangleId>& gone, Patch& patch) {
    gone.clear();
    patch.clear();
    const Edge back = slots_.twin(e);
    if (slots_.is_ghost(triangle_of(e)) || slots_.is_ghost(triangle_of(back))) return;
    if (!conflicts(triangle_of(e), slots_.apex(back))) return;
    gone_ = &gone;
    patch_ = &patch;
    rims_.clear();
    gone.assign({triangle_of(e), triangle_of(back)});
    begin(e);
    while (extend()) {
    }
    std::sort(gone.begin(), gone.end());
    gone.erase(std::unique(gone.begin(), gone.end()), gone.end());
    join(patch);
}

}  // namespace liftmesh::dynamic
