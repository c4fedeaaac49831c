#include "delaunay/walk.hpp"

#include <algorithm>

namespace liftmesh {

// Rarely needed, and so kept out of the loops of steps.
[[gnu::cold, gnu::noinline]] Pair Walk::exact_turns() {
    const Point tail = mesh_->corner(at_, wrapped(k_ + 2)),
                head = mesh_->corner(at_, wrapped(k_ + 1));
    const Point apex = mesh_->corner(at_, k_), query = point(query_);
    const int turns[2] = {orient2d(tail, apex, query), orient2d(apex, head, query)};
    is_in_doubt_ |= (turns[0] == 0) | (turns[1] == 0);
    return Pair{static_cast<double>(turns[0]), static_cast<double>(turns[1])};
}

// Among the triangles that share the side or the corner on which the query lies.
std::int32_t Walk::least_here(const Hubs* hubs) const {
    int turn[3], on = 0;
    for (int k = 0; k < 3; ++k) {
        turn[k] = orient2d(mesh_->corner(at_, (k + 1) % 3), mesh_->corner(at_, (k + 2) % 3),
                           point(query_));
        if (turn[k] < 0) return outside;
        on += turn[k] == 0;
    }
    if (on == 2) return least_around(turn[0] != 0 ? 0 : turn[1] != 0 ? 1 : 2, hubs);
    const int side = turn[0] == 0 ? 0 : turn[1] == 0 ? 1 : 2;
    const std::int32_t across = mesh_->neighbor(at_, side);
    return across < 0 ? at_ : std::min(at_, across);
}

// Goes around a vertex counter-clockwise and, if that reaches the hull, clockwise from the start.
std::int32_t Walk::least_around(int k, const Hubs* hubs) const {
    const std::int32_t centre = mesh_->vertex(at_, k);
    const std::int32_t known = hubs ? hubs->least_triangle(centre) : -1;
    if (known >= 0) return known;
    std::int32_t least = at_;
    int visited = 0;
    for (const int turn : {1, 2}) {
        std::int32_t at = at_;
        int place = k;
        while (++visited <= 2 * Hubs::least_degree) {
            at = mesh_->neighbor(at, (place + turn) % 3);
            if (at == at_) return least;
            if (at < 0) break;
            least = std::min(least, at);
            for (place = 0; mesh_->vertex(at, place) != centre;) ++place;
        }
    }
    return visited > 2 * Hubs::least_degree ? unfinished : least;
}

}  // namespace liftmesh
