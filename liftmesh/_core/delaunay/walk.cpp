#include "delaunay/walk.hpp"

#include <algorithm>

namespace liftmesh {

// Among the triangles that share the side or the corner on which the query lies.
std::int32_t Walk::least_here(const Hubs* hubs) const {
    const int on = (turn_[0] == 0) + (turn_[1] == 0) + (turn_[2] == 0);
    if (on == 2) {
        const int off = turn_[0] != 0 ? 0 : turn_[1] != 0 ? 1 : 2;
        return least_around(wrapped(k_ + off), hubs);
    }
    const int side = turn_[0] == 0 ? 0 : turn_[1] == 0 ? 1 : 2;
    const std::int32_t across = mesh_->neighbor(at_, wrapped(k_ + side));
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
