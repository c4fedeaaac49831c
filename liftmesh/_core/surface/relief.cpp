#include "surface/relief.hpp"

namespace liftmesh {

double Relief::height(Point query, std::int32_t simplex, Patience& patience) const {
    return height(query, simplex, place(query, simplex), patience);
}

double Relief::height(Point query, std::int32_t simplex, Place place, Patience& patience) const {
    if (place.kind == Place::vertex && !is_shown(simplex) &&
        owner_of_vertex(mesh_.vertex(simplex, place.k), simplex, patience) < 0)
        return no_height;
    return height(query, simplex, place);
}

double Relief::height(Point query, std::int32_t simplex, Place place) const {
    const auto [kind, k] = place;
    if (kind == Place::inside) return is_shown(simplex) ? facet(simplex).height(query) : no_height;
    if (kind == Place::side) {
        if (!is_shown(simplex, place)) return no_height;
        return height_between(corner(simplex, (k + 1) % 3), corner(simplex, (k + 2) % 3), query);
    }
    return kind == Place::beyond ? no_height : heights_[mesh_.vertex(simplex, k)];
}

bool Relief::owns_side(std::int32_t simplex, int k) const {
    const Point tail = mesh_.corner(simplex, (k + 1) % 3),
                head = mesh_.corner(simplex, (k + 2) % 3);
    return head.y < tail.y || (head.y == tail.y && tail.x < head.x) ||
           !is_shown(mesh_.neighbor(simplex, k));
}

std::int32_t Relief::owner(Point query, std::int32_t simplex, Patience& patience) const {
    const auto [kind, k] = place(query, simplex);
    if (kind == Place::beyond) return outside;
    if (kind == Place::inside) return is_shown(simplex) ? simplex : outside;
    if (kind == Place::vertex) return owner_of_vertex(mesh_.vertex(simplex, k), simplex, patience);
    const std::int32_t across = mesh_.neighbor(simplex, k);
    if (is_shown(simplex) && owns_side(simplex, k)) return simplex;
    return is_shown(across) ? across : outside;
}

std::int32_t Relief::owner_of_vertex(std::int32_t row, std::int32_t simplex,
                                     Patience& patience) const {
    if (const std::size_t credit = first_faces_.credit()) {
        std::size_t left = credit;
        const std::int32_t found = first_face_around(mesh_, shown_, row, simplex, left);
        first_faces_.pay(credit - left);
        if (found != unfinished) return found;
    }
    const auto make = [&] { return std::make_unique<const FirstFaces>(mesh_, shown_, patience); };
    const FirstFaces* faces = first_faces_.get(make, patience);
    return faces ? (*faces)[row] : unfinished;
}

std::int32_t Relief::nearest(Point query, std::int32_t simplex, Patience& patience) const {
    constexpr std::size_t short_walk = 64;
    std::size_t left = short_walk;
    std::int32_t found = nearest_vertex(mesh_, query, simplex, left);
    if (found != unfinished) return found;
    if (const std::size_t credit = nearest_tree_.credit()) {
        left = credit;
        found = nearest_vertex(mesh_, query, simplex, left);
        nearest_tree_.pay(credit - left);
        if (found != unfinished) return found;
    }
    const auto make = [&] { return std::make_unique<const NearestTree>(mesh_, patience); };
    const NearestTree* tree = nearest_tree_.get(make, patience);
    return tree ? tree->nearest(mesh_, query, mesh_.vertex(std::max(simplex, 0), 0)) : unfinished;
}

}  // namespace liftmesh
