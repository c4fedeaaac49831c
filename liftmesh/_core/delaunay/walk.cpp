#include "delaunay/walk.hpp"

namespace liftmesh {

// Rarely needed, and so kept out of the loops of steps.
[[gnu::cold, gnu::noinline]] Pair Walk::exact_turns() {
    ++exact_steps_;
    const Point tail = mesh_->corner(at_, wrapped(k_ + 2)),
                head = mesh_->corner(at_, wrapped(k_ + 1));
    const Point apex = mesh_->corner(at_, k_), query = point(query_);
    const int turns[2] = {orient2d(tail, apex, query), orient2d(apex, head, query)};
    is_in_doubt_ |= (turns[0] == 0) | (turns[1] == 0);
    return Pair{static_cast<double>(turns[0]), static_cast<double>(turns[1])};
}

// A triangle is above an edge that runs to the right, with the triangle on its left.
bool VerticalWalk::begin(Point query, std::uint32_t edge) {
    const int k = static_cast<int>(edge % 3);
    query_ = query;
    at_ = static_cast<std::int32_t>(edge / 3);
    tail_ = mesh_->place(at_, (k + 1) % 3);
    head_ = mesh_->place(at_, (k + 2) % 3);
    is_outside_ = false;
    const int turn = orient2d(point(tail_), point(head_), query);
    is_in_doubt_ = turn == 0;
    goes_up_ = before_xy(point(tail_), point(head_)) == (turn > 0);
    if (is_in_doubt_) return false;
    if (turn > 0) {
        look(k);
        return true;
    }
    std::swap(tail_, head_);
    if (!cross(at_, k)) return false;
    look();
    return true;
}

std::uint32_t VerticalWalk::start_for(Point query) const {
    const std::uint32_t first = 3 * static_cast<std::uint32_t>(at_);
    for (std::uint32_t edge = first; edge < first + 3; ++edge)
        if (segment(*mesh_, edge).meets_vertical_line_through(query)) return edge;
    return no_edge;
}

}  // namespace liftmesh
