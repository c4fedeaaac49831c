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

}  // namespace liftmesh
