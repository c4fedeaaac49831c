// Points that come and go: after every few changes the triangles are those of a fresh run.
#include "changing.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "structure.hpp"

namespace fuzzing {

namespace {

using liftmesh::Point;
using liftmesh::Vertex;
using liftmesh::dynamic::Triangulation;
using Corners = std::array<double, 6>;

// Triangles as sets of positions: of each, the lexicographically least corner comes first.
template <class At>
std::vector<Corners> sorted(const liftmesh::Result& result, At at) {
    std::vector<Corners> found;
    for (std::size_t i = 0; i < result.triangle_count; ++i) {
        Point corners[3];
        for (int k = 0; k < 3; ++k) corners[k] = at(result.simplices[3 * i + k]);
        std::rotate(corners, std::min_element(corners, corners + 3, liftmesh::before_xy),
                    corners + 3);
        found.push_back(
            {corners[0].x, corners[0].y, corners[1].x, corners[1].y, corners[2].x, corners[2].y});
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace

void compare_with_fresh(const Triangulation& mesh) {
    std::vector<Point> present;
    std::vector<Vertex> vertex;
    for (Vertex v = 0; v < mesh.vertex_end(); ++v) {
        if (!mesh.is_present(v)) continue;
        present.push_back(mesh.point(v));
        vertex.push_back(v);
    }
    demand(present.size() == mesh.size(), "points are counted wrongly");
    std::vector<std::int32_t> edges;
    for (const auto [a, b] : mesh.constraints().wholes())
        for (const Vertex v : {a, b}) {
            const auto at = std::lower_bound(vertex.begin(), vertex.end(), v);
            edges.push_back(static_cast<std::int32_t>(at - vertex.begin()));
        }
    Impatient interrupt;
    const auto fresh = liftmesh::constrained_delaunay(
        liftmesh::dynamic::input_of(present), edges.data(), edges.size() / 2, false, {}, interrupt);
    demand(fresh.crossings.empty(), "constraints cross");
    std::set<liftmesh::dynamic::Piece> pieces, wanted;
    for (const auto& [each, whole] : mesh.constraints().parts()) pieces.insert(each);
    for (const auto [a, b] : fresh.pieces) wanted.insert({vertex[a], vertex[b]});
    demand(!mesh.has_triangles() || pieces == wanted, "constraints have other pieces");
    const auto place = [&](std::int32_t row) { return present[static_cast<std::size_t>(row)]; };
    const auto own = [&](std::int32_t v) { return mesh.point(static_cast<Vertex>(v)); };
    demand(sorted(mesh.result(), own) == sorted(fresh.result, place),
           "points that came and went leave other triangles");
}

void judge(const Triangulation& mesh) {
    Case c{Check::location, false, {}, {}, nullptr, {}, Dice(0), false};
    Rows present;
    for (Vertex v = 0; v < mesh.vertex_end(); ++v) {
        const Point p = mesh.is_present(v) ? mesh.point(v) : Point{0, 0};
        c.points.push_back({p.x, p.y, 0});
        if (mesh.is_present(v)) present.push_back(v);
    }
    const liftmesh::Result result = mesh.result();
    if (result.triangle_count == 0) return;
    std::int32_t* const hull = result.hull.get();  // from anywhere, but for a fresh run's
    std::int32_t* const end = hull + result.hull_count;
    std::rotate(hull,
                std::min_element(hull, end,
                                 [&](std::int32_t u, std::int32_t v) {
                                     return liftmesh::before_xy(mesh.point(static_cast<Vertex>(u)),
                                                                mesh.point(static_cast<Vertex>(v)));
                                 }),
                end);
    demand(check_structure(c, result, present).size() == present.size(), "a point is no vertex");
    check_delaunay(c, result);
}

void check_changes(Case& c, const Rows& rows) {
    Triangulation mesh;
    std::vector<Vertex> present;
    for (std::size_t step = 0; step < std::min<std::size_t>(3 * rows.size(), 400); ++step) {
        if (present.empty() || c.dice.below(3) != 0) {
            const std::size_t row = rows[c.dice.below(rows.size())];
            const Vertex v = mesh.insert(c.input[row]);
            demand(mesh.point(v) == c.input[row], "a point is elsewhere");
            if (std::find(present.begin(), present.end(), v) == present.end()) present.push_back(v);
        } else {
            const std::size_t at = c.dice.below(present.size());
            mesh.remove(present[at]);
            present.erase(present.begin() + static_cast<std::ptrdiff_t>(at));
        }
        if (step % 16 == 0) compare_with_fresh(mesh);
    }
    compare_with_fresh(mesh);
    for (const Vertex v : present) mesh.remove(v);
    demand(mesh.size() == 0 && mesh.result().triangle_count == 0, "something is left");
}

}  // namespace fuzzing
