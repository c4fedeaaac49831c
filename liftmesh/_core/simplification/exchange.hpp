// Changes of a finished approximation that keep it within the tolerance, and after which it has no
// more vertices than before. Each either succeeds, or leaves everything as it was.
//
// - A vertex is exchanged for the worst of the other samples that its removal leaves.
// - A sample becomes a vertex, so that neighbours can go: one after the other, or two at once of
//   which neither may go alone. The removal of the first leaves triangles beyond the tolerance
//   then, and the second is a corner of all of them.
//
// After either, neighbours that are not needed any longer are removed.
#pragma once

#include "simplification/cover.hpp"
#include "simplification/removal.hpp"

namespace liftmesh::simplification {

// The largest distance after the removal; none, if it exceeds the tolerance.
struct ByTolerance {
    void add_before(const Facet&, const Sample&) {}
    bool add_after(const Facet& facet, const Sample& sample) {
        const double distance = facet.distance(sample);
        if (facet.exceeds(sample, distance)) return false;
        cost = std::max(cost, distance);
        return true;
    }
    static bool is_first(Point p, Point q) { return before_xy(p, q); }
    static constexpr bool needs_before = false;
    double cost = 0;
};

template <class Samples>
class Exchange {
 public:
    using Vertices = std::vector<Vertex>;
    using Triangles = std::vector<TriangleId>;

    Exchange(Cover<Samples>& cover, Removal<Samples, ByTolerance>& removal)
        : cover_(cover), removal_(removal) {}

    // Exchanges a vertex.
    void replace(Vertex v);
    // Makes a sample a vertex, if it is none, so that others can go; it is near that vertex.
    void add(std::uint32_t s, Vertex near);
    // The worst sample of a triangle, of several the lexicographically least; also one without any
    // distance. `none` if it has but its corners.
    std::uint32_t worst_of(TriangleId t);

 private:
    // What a vertex may be exchanged for, and the triangle of the patch in which it is.
    struct Substitute {
        double distance = 0;
        std::uint32_t sample = none;
        std::size_t place = 0;
    };

    Substitute substitute(Vertex v);
    bool is_within(TriangleId t);
    bool are_within(const Triangles& triangles);
    bool are_within_around(const Vertices& vertices);
    void offer_around(const Vertices& link, const Vertices& other);
    Vertices border() const;
    Vertices take_out(Vertex v);
    void put_in(std::uint32_t s, Vertex near);
    bool remove_around(Vertex v, const Vertices& link);
    bool remove_two(Vertex held, const Vertices& link);
    bool remove_another(Vertex held, const Vertices& link);
    Vertices common_corners(const Triangles& triangles);

    Cover<Samples>& cover_;
    Removal<Samples, ByTolerance>& removal_;
    Triangles filled_;
    dynamic::Star star_;
};

// The worst sample of the patch, of several the lexicographically least. There is none if all
// others are on its planes.
template <class Samples>
auto Exchange<Samples>::substitute(Vertex v) -> Substitute {
    Substitute worst;
    const auto consider = [&](std::size_t i, std::uint32_t s, const Sample& sample) {
        const Facet& facet = removal_.facet(i);
        const double distance = facet.distance(sample);
        if (distance < worst.distance || s == cover_.number(v)) return true;
        if (facet.is_corner(sample.point)) return true;
        const bool is_tie = distance == worst.distance && worst.sample != none;
        if (distance > worst.distance || (is_tie && cover_.is_before(s, worst.sample)))
            worst = {distance, s, i};
        return true;
    };
    cover_.each_after(v, removal_.star(), removal_.patch(), consider);
    return worst;
}

template <class Samples>
void Exchange<Samples>::replace(Vertex v) {
    if (!removal_.plan(v)) return;
    const Substitute other = substitute(v);
    if (other.sample == none) return;
    const std::uint32_t removed = cover_.number(v);
    const Vertices link = take_out(v);
    filled_ = cover_.filled();
    const Vertex inserted = cover_.insert(other.sample, filled_[other.place]);
    // What this has made: the star of the vertex that came, and what is left of the patch.
    if (are_within(cover_.mesh().star()) && are_within(filled_))
        return offer_around(link, border());
    // The triangulation is again what it was, as it depends on the vertices alone.
    removal_.plan_any(inserted);
    take_out(inserted);
    put_in(removed, link[0]);
}

template <class Samples>
std::uint32_t Exchange<Samples>::worst_of(TriangleId t) {
    std::uint32_t worst = none;
    if (!cover_.may_have_samples(t)) return worst;
    const Facet facet = cover_.facet(t);
    double most = 0;
    cover_.each_of(t, [&](std::uint32_t s, const Sample& sample) {
        const double distance = facet.distance(sample);
        if (!(distance >= most) || facet.is_corner(sample.point)) return true;
        if (distance == most && worst != none && !cover_.is_before(s, worst)) return true;
        most = distance;
        worst = s;
        return true;
    });
    return worst;
}

template <class Samples>
void Exchange<Samples>::add(std::uint32_t s, Vertex near) {
    const Vertex hint = cover_.mesh().is_present(near) ? near : ghost;
    const dynamic::Place place = cover_.mesh().locate(cover_.sample(s).point, hint);
    if (place.vertex != ghost) return;
    const Vertex v = cover_.insert(s, place.triangle);
    const Vertices link = border();
    if (are_within(cover_.mesh().star()) && (remove_around(v, link) || remove_two(v, link)))
        return offer_around(link, {v});
    removal_.plan_any(v);
    take_out(v);
}

template <class Samples>
bool Exchange<Samples>::is_within(TriangleId t) {
    const dynamic::Slots& slots = cover_.mesh().slots();
    if (slots.is_free(t) || slots.is_ghost(t) || !cover_.may_have_samples(t)) return true;
    const Facet facet = cover_.facet(t);
    return cover_.each_of(t, [&](std::uint32_t, const Sample& sample) {
        return !facet.exceeds(sample, facet.distance(sample));
    });
}

template <class Samples>
bool Exchange<Samples>::are_within(const Triangles& triangles) {
    return std::all_of(triangles.begin(), triangles.end(),
                       [this](TriangleId t) { return is_within(t); });
}

template <class Samples>
bool Exchange<Samples>::are_within_around(const Vertices& vertices) {
    return std::all_of(vertices.begin(), vertices.end(), [this](Vertex v) {
        if (!cover_.mesh().is_present(v)) return true;
        cover_.mesh().find_star(v, star_);
        return are_within(star_.triangles);
    });
}

// Those of both that are still there; then those that are not needed go.
template <class Samples>
void Exchange<Samples>::offer_around(const Vertices& link, const Vertices& other) {
    Vertices around = link;
    for (const Vertex v : other)
        if (std::find(link.begin(), link.end(), v) == link.end()) around.push_back(v);
    std::erase_if(around, [this](Vertex v) { return !cover_.mesh().is_present(v); });
    for (const Vertex v : around) removal_.touch(v);
    for (const Vertex v : around) removal_.offer(v);
    removal_.run();
}

// The neighbours of the vertex that was inserted last.
template <class Samples>
auto Exchange<Samples>::border() const -> Vertices {
    Vertices found;
    for (const dynamic::BorderEdge& each : cover_.mesh().border())
        if (each.tail != ghost) found.push_back(each.tail);
    return found;
}

// As planned; returns its neighbours.
template <class Samples>
auto Exchange<Samples>::take_out(Vertex v) -> Vertices {
    Vertices link = removal_.star().link;
    std::erase(link, ghost);
    cover_.remove(v, removal_.star(), removal_.patch());
    return link;
}

template <class Samples>
void Exchange<Samples>::put_in(std::uint32_t s, Vertex near) {
    cover_.insert(s, cover_.mesh().locate(cover_.sample(s).point, near).triangle);
}

// Whether any could go.
template <class Samples>
bool Exchange<Samples>::remove_around(Vertex v, const Vertices& link) {
    const std::size_t before = cover_.vertices();
    removal_.hold(v);
    for (const Vertex each : link) removal_.offer(each);
    removal_.run();
    removal_.hold(ghost);
    return cover_.vertices() < before;
}

template <class Samples>
bool Exchange<Samples>::remove_two(Vertex held, const Vertices& link) {
    for (const Vertex v : link) {
        if (!removal_.plan(v)) continue;
        const std::uint32_t first = cover_.number(v);
        const Vertices around = take_out(v);
        if (remove_another(held, around)) return true;
        put_in(first, held);
    }
    return false;
}

// After the removal of a vertex that had these neighbours.
template <class Samples>
bool Exchange<Samples>::remove_another(Vertex held, const Vertices& link) {
    filled_ = cover_.filled();
    for (const Vertex v : common_corners(filled_)) {
        if (v == held || !removal_.plan(v)) continue;
        const std::uint32_t second = cover_.number(v);
        const Vertices around = take_out(v);
        // A sample on an edge may have changed sides when another vertex was put back.
        if (are_within(cover_.filled()) && are_within_around(link)) {
            offer_around(link, around);
            return true;
        }
        put_in(second, held);
    }
    return false;
}

// Of those triangles that are beyond the tolerance.
template <class Samples>
auto Exchange<Samples>::common_corners(const Triangles& triangles) -> Vertices {
    const dynamic::Slots& slots = cover_.mesh().slots();
    Vertices common;
    bool is_first = true;
    for (const TriangleId t : triangles) {
        if (is_within(t)) continue;
        const Vertex corners[] = {slots.vertex(t, 0), slots.vertex(t, 1), slots.vertex(t, 2)};
        if (is_first) common.assign(corners, corners + 3);
        is_first = false;
        std::erase_if(common,
                      [&](Vertex v) { return std::find(corners, corners + 3, v) == corners + 3; });
        if (common.empty()) break;
    }
    return common;
}

}  // namespace liftmesh::simplification
