#include "simplification/lists.hpp"

#include "delaunay/locate.hpp"
#include "sorting/hilbert.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh::simplification {

bool Lists::fill(const Terrain& terrain, Interrupt& interrupt) {
    Bounds box = Bounds::nothing();
    for (std::size_t i = 0; i < terrain.count; ++i) box.add(pair(terrain.points[i]));
    const HilbertCurve curve(box);
    entries_.resize(terrain.count);
    Patience patience(interrupt);
    for (std::size_t i = 0; i < terrain.count; ++i) {
        const Point p = terrain.points[i];
        entries_[i] = {{p, terrain.heights[i]}, static_cast<Row>(i), curve(p)};
        if (patience.ends()) return false;
    }
    const auto is_less = [](const Entry& a, const Entry& b) {
        const Point p = a.sample.point, q = b.sample.point;
        return std::tie(a.next, p.x, p.y) < std::tie(b.next, q.x, q.y);
    };
    if (!patient_sort(entries_, is_less, interrupt)) return false;
    for (Entry& each : entries_) each.next = none;
    return true;
}

std::vector<std::uint32_t> Lists::of_rows(const std::vector<Row>& rows) const {
    std::vector<std::uint32_t> place(entries_.size()), found;
    for (std::uint32_t s = 0; s < entries_.size(); ++s) place[entries_[s].row] = s;
    for (const Row row : rows) found.push_back(place[row]);
    return found;
}

bool Lists::deal(const dynamic::Triangulation& mesh, Interrupt& interrupt) {
    clear(mesh);
    if (!mesh.constraints().empty()) return deal_among_edges(mesh, interrupt);
    Patience patience(interrupt);
    Vertex last = ghost;
    for (std::uint32_t s = 0; s < entries_.size(); ++s) {
        if (patience.ends()) return false;
        const dynamic::Place found = mesh.locate(entries_[s].sample.point, last);
        if (found.vertex == ghost) add(found.triangle, s);
        last = mesh.slots().vertex(found.triangle, 0);
    }
    return true;
}

// The ends of edges may have long stars, and few of them slivers between, in which walks are long.
bool Lists::deal_among_edges(const dynamic::Triangulation& mesh, Interrupt& interrupt) {
    const Result whole = mesh.result();
    std::vector<Point> vertices(mesh.vertex_end()), queries(entries_.size());
    for (Vertex v = 0; v < vertices.size(); ++v) vertices[v] = mesh.point(v);
    for (std::size_t s = 0; s < queries.size(); ++s) queries[s] = entries_[s].sample.point;
    std::vector<TriangleId> triangles;  // by their numbers
    for (TriangleId t = 0; t < mesh.slots().end(); t += words_per_triangle)
        if (!mesh.slots().is_free(t) && !mesh.slots().is_ghost(t)) triangles.push_back(t);
    Locator locator({dynamic::input_of(vertices), whole.simplices.get(), whole.neighbors.get(),
                     whole.triangle_count},
                    0);
    std::vector<std::int32_t> found(queries.size());
    const bool is_whole =
        locator.find({&queries[0].x, queries.size()}, found.data(), {1, false}, interrupt);
    for (std::uint32_t s = 0; is_whole && s < queries.size(); ++s) {
        const TriangleId t = triangles[static_cast<std::size_t>(found[s])];
        bool is_vertex = false;
        for (unsigned k = 0; k < 3; ++k)
            is_vertex |= mesh.point(mesh.slots().vertex(t, k)) == queries[s];
        if (!is_vertex) add(t, s);
    }
    return is_whole;
}

void Lists::release(const dynamic::Triangulation& mesh) {
    released_.clear();
    for (const TriangleId t : mesh.cavity()) {
        released_.push_back(first_[slot_of(t)]);
        first_[slot_of(t)] = none;
    }
}

// Those around the new vertex, counter-clockwise; on the hull from one side of the gap to the
// other.
void Lists::find_wedges(const dynamic::Triangulation& mesh) {
    ends_.clear();
    wedges_.clear();
    const std::vector<dynamic::BorderEdge>& border = mesh.border();
    const std::size_t count = border.size();
    std::size_t start = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (border[i].tail == ghost) start = i + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = (start + i) % count;
        if (border[at].tail == ghost) break;
        ends_.push_back(mesh.point(border[at].tail));
        if (border[at].head != ghost) wedges_.push_back(mesh.star()[at]);
    }
}

// From the k-th wedge on, counter-clockwise if the point is not to the right of its first end.
inline std::size_t Lists::wedge_of(Point apex, Point p, std::size_t k) const {
    const std::size_t count = wedges_.size();
    const auto is_left = [&](std::size_t i) { return turns_(apex, ends_[i], p) >= 0; };
    if (!is_left(k)) {
        do k = k == 0 ? count - 1 : k - 1;
        while (!is_left(k));
        return k;
    }
    const bool is_closed = ends_.size() == count;
    for (;;) {
        if (k + 1 == count && !is_closed) return k;
        const std::size_t following = k + 1 == count ? 0 : k + 1;
        if (!is_left(following)) return k;
        k = following;
    }
}

void Lists::settle(const dynamic::Triangulation& mesh, std::uint32_t inserted) {
    first_.resize(slot_of(mesh.slots().end()), none);
    find_wedges(mesh);
    const Point apex = entries_[inserted].sample.point;
    std::size_t k = 0;
    for (std::uint32_t s : released_) {
        while (s != none) {
            const std::uint32_t following = entries_[s].next;
            if (following != none) prefetch(following);
            if (s != inserted) {
                k = wedge_of(apex, entries_[s].sample.point, k);
                add(wedges_[k], s);
            }
            s = following;
        }
    }
}

void Lists::release(const dynamic::Star& star, std::uint32_t removed) {
    moved_.assign(1, removed);
    for (const TriangleId t : star.triangles) {
        for (std::uint32_t s = first_[slot_of(t)]; s != none; s = entries_[s].next)
            moved_.push_back(s);
        first_[slot_of(t)] = none;
    }
}

void Lists::settle(const dynamic::Triangulation& mesh, const dynamic::Patch& patch,
                   const std::vector<TriangleId>& made) {
    for (const std::uint32_t s : moved_) add(made[find(mesh, patch, entries_[s].sample.point)], s);
}

std::size_t Lists::find(const dynamic::Triangulation& mesh, const dynamic::Patch& patch,
                        Point p) const {
    for (std::size_t i = 0;; ++i) {
        const Vertex* corners = &patch.vertices[3 * i];
        if (corners[0] == ghost || corners[1] == ghost || corners[2] == ghost) continue;
        bool is_inside = true;
        for (int k = 0; k < 3 && is_inside; ++k)
            is_inside = turns_(mesh.point(corners[k]), mesh.point(corners[(k + 1) % 3]), p) >= 0;
        if (is_inside) return i;
    }
}

}  // namespace liftmesh::simplification
