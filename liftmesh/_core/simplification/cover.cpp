#include "simplification/cover.hpp"

namespace liftmesh::simplification {

Cover::Cover(const Terrain& terrain, double tolerance)
    : tolerance_(tolerance),
      turns_(terrain),
      samples_(samples_of(terrain)),
      corners_(corners_of(terrain)) {}

Corner Cover::corner(Vertex v) const {
    const Sample& found = samples_[sample_of_[v]];
    return {found.point, found.height};
}

Facet Cover::facet(const Vertex* corners) const {
    return {corner(corners[0]), corner(corners[1]), corner(corners[2]), tolerance_};
}

Facet Cover::facet(TriangleId t) const {
    const Vertex corners[3] = {mesh_.slots().vertex(t, 0), mesh_.slots().vertex(t, 1),
                               mesh_.slots().vertex(t, 2)};
    return facet(corners);
}

void Cover::note_vertex(Vertex v, std::uint32_t s) {
    if (v >= sample_of_.size()) {
        sample_of_.resize(v + 1, none);
        is_corner_.resize(v + 1, false);
    }
    sample_of_[v] = s;
}

bool Cover::begin_with_corners(Interrupt& interrupt) {
    Patience patience(interrupt);
    std::vector<std::uint32_t> place(samples_.size());
    for (std::uint32_t s = 0; s < samples_.size(); ++s) place[samples_[s].row] = s;
    Vertex last = ghost;
    for (const Row row : corners_) {
        if (patience.ends(64)) return false;
        last = mesh_.insert(samples_[place[row]].point, last);
        note_vertex(last, place[row]);
        is_corner_[last] = true;
    }
    first_.assign(slot_of(mesh_.slots().end()), none);
    for (std::uint32_t s = 0; s < samples_.size(); ++s) {
        if (patience.ends()) return false;
        const dynamic::Place found = mesh_.locate(samples_[s].point, last);
        if (found.vertex == ghost) add_to(found.triangle, s);
        last = mesh_.slots().vertex(found.triangle, 0);
    }
    return true;
}

Status Cover::begin_with_all(Interrupt& interrupt) {
    std::vector<Point> points(samples_.size());
    for (std::size_t s = 0; s < samples_.size(); ++s) points[s] = samples_[s].point;
    std::vector<Vertex> found(samples_.size());
    const Status status = mesh_.insert(dynamic::input_of(points), found.data(), interrupt);
    if (status != Status::ok) return status;
    std::vector<bool> is_corner(samples_.size());
    for (const Row row : corners_) is_corner[row] = true;
    for (std::uint32_t s = 0; s < samples_.size(); ++s) {
        note_vertex(found[s], s);
        is_corner_[found[s]] = is_corner[samples_[s].row];
    }
    first_.assign(slot_of(mesh_.slots().end()), none);
    return Status::ok;
}

// The samples of triangles, which lose them.
void Cover::collect(const std::vector<TriangleId>& triangles) {
    moved_.clear();
    for (const TriangleId t : triangles) {
        each_of(t, [&](std::uint32_t s) { moved_.push_back(s); });
        first_[slot_of(t)] = none;
    }
}

// The heads of their lists.
void Cover::take_lists(const std::vector<TriangleId>& triangles) {
    lists_.clear();
    for (const TriangleId t : triangles) {
        lists_.push_back(first_[slot_of(t)]);
        first_[slot_of(t)] = none;
    }
}

// Those around the new vertex, counter-clockwise; on the hull from one side of the gap to the
// other.
void Cover::find_wedges() {
    ends_.clear();
    wedges_.clear();
    const std::vector<dynamic::BorderEdge>& border = mesh_.border();
    const std::size_t count = border.size();
    std::size_t start = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (border[i].tail == ghost) start = i + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = (start + i) % count;
        if (border[at].tail == ghost) break;
        ends_.push_back(mesh_.point(border[at].tail));
        if (border[at].head != ghost) wedges_.push_back(made()[at]);
    }
}

std::vector<Row> Cover::rows() const {
    std::vector<Row> found;
    for (Vertex v = 0; v < mesh_.vertex_end(); ++v)
        if (mesh_.is_present(v)) found.push_back(samples_[sample_of_[v]].row);
    return found;
}

}  // namespace liftmesh::simplification
