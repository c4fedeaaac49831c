// Edges between rows as the bytes say: what they become is what trying all pairs tells, by integers
// of any length, and every other edge of the triangulation is canonical.
#include <algorithm>
#include <tuple>
#include <vector>

#include "checks.hpp"
#include "constrained/regions.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "targets.hpp"

namespace fuzzing {

namespace {

using liftmesh::Constrained;
using liftmesh::Row;
using liftmesh::Status;
using liftmesh::constrained::Carving;
using liftmesh::constrained::Crossing;
using liftmesh::constrained::EdgeId;
using liftmesh::constrained::Piece;

constexpr std::size_t most_edges = 48;
constexpr Row nowhere = ~Row{0};

struct Membership {
    Piece piece;
    EdgeId edge;
    auto operator<=>(const Membership&) const = default;
};

// What there is to find.
class Definition {
 public:
    Definition(const Case& c, const Expectation& expected, const std::vector<std::int32_t>& edges)
        : c_(c), kept_(expected.kept), row_of_(c.rows(), nowhere) {
        for (const Row row : kept_) row_of_[row] = row;
        for (const liftmesh::Duplicate& pair : expected.merged) row_of_[pair.row] = pair.kept;
        std::sort(kept_.begin(), kept_.end(),
                  [&](Row a, Row b) { return liftmesh::before_xy(c.point(a), c.point(b)); });
        for (std::size_t i = 0; i < edges.size(); i += 2)
            add({row_of_[static_cast<std::size_t>(edges[i])],
                 row_of_[static_cast<std::size_t>(edges[i + 1])]});
        std::sort(memberships.begin(), memberships.end());
    }

    std::vector<Membership> memberships;
    std::vector<EdgeId> zero_length, unplaced;
    std::vector<Crossing> crossings;

    bool has(Row a, Row b) const {
        const Piece piece{std::min(a, b), std::max(a, b)};
        return std::any_of(memberships.begin(), memberships.end(),
                           [&](const Membership& each) { return each.piece == piece; });
    }

 private:
    void add(Piece ends) {
        const auto id = static_cast<EdgeId>(ends_.size());
        ends_.push_back(ends);
        if (ends.first == nowhere || ends.second == nowhere) return unplaced.push_back(id);
        if (ends.first == ends.second) return zero_length.push_back(id);
        Row last = nowhere;
        for (const Row row : kept_) {
            if (!is_on(ends, row)) continue;
            if (last != nowhere)
                memberships.push_back({{std::min(last, row), std::max(last, row)}, id});
            last = row;
        }
        for (EdgeId other = 0; other < id; ++other)
            if (cross(ends, ends_[other])) crossings.push_back({other, id});
    }

    Point at(Row row) const { return c_.point(row); }
    bool is_on(Piece ends, Row row) const {
        const auto [low, high] =
            std::minmax({at(ends.first), at(ends.second)}, liftmesh::before_xy);
        return !liftmesh::before_xy(at(row), low) && !liftmesh::before_xy(high, at(row)) &&
               turn(low, high, at(row)) == 0;
    }
    bool part(Piece line, Piece ends) const {
        const Point a = at(line.first), b = at(line.second);
        return turn(a, b, at(ends.first)) * turn(a, b, at(ends.second)) < 0;
    }
    bool cross(Piece a, Piece b) const {
        const bool placed = b.first != nowhere && b.second != nowhere;
        return placed && part(a, b) && part(b, a) &&
               std::none_of(kept_.begin(), kept_.end(),
                            [&](Row row) { return is_on(a, row) && is_on(b, row); });
    }

    const Case& c_;
    Rows kept_, row_of_;
    std::vector<Piece> ends_;
};

Constrained run(const Case& c, const std::vector<std::int32_t>& edges, liftmesh::Threads threads,
                std::size_t patience = ~std::size_t{0}) {
    Impatient interrupt(patience);
    return liftmesh::constrained_delaunay(c.input, edges.data(), edges.size() / 2,
                                          c.skip_non_finite, threads, interrupt);
}

void check_pieces(const Constrained& found, const Definition& expected) {
    std::vector<Membership> memberships;
    demand(found.starts.size() == found.pieces.size() + 1, "pieces without members");
    for (std::size_t i = 0; i < found.pieces.size(); ++i)
        for (std::size_t j = found.starts[i]; j < found.starts[i + 1]; ++j)
            memberships.push_back({found.pieces[i], found.members[j]});
    demand(memberships == expected.memberships, "edges became other pieces");
}

void check_marks(const Constrained& found, const Definition& expected) {
    const std::int32_t* corners = found.result.simplices.get();
    for (std::size_t t = 0; t < found.result.triangle_count; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto corner = [&](std::size_t i) {
                return static_cast<Row>(corners[3 * t + (k + i) % 3]);
            };
            demand((found.marks[t] >> k & 1) == expected.has(corner(1), corner(2)),
                   "marks are not those of the pieces");
        }
}

// Regions end at constraints, and carving takes whole ones: all of those that are open outwards.
void check_regions(const Constrained& found) {
    const std::size_t count = found.result.triangle_count;
    const liftmesh::constrained::Marked mesh{found.result.neighbors.get(), found.marks.data(),
                                             count};
    const std::vector<std::int32_t> labels = liftmesh::constrained::label(mesh);
    const std::vector<std::uint8_t> all(found.pieces.size(), 1);
    const std::vector<std::int32_t> none(found.pieces.size());
    for (const Carving carving : {Carving::outside, Carving::holes}) {
        const auto kept =
            liftmesh::constrained::carve(mesh, found.result.simplices.get(),
                                         {found.pieces, all.data(), none.data()}, carving, {});
        demand(kept.size() == count && labels.size() == count, "triangles are lost");
        for (std::size_t t = 0; t < count; ++t)
            for (unsigned k = 0; k < 3; ++k) {
                if (mesh.is_marked(t, k)) continue;
                const std::int32_t u = mesh.neighbor(t, k);
                if (u < 0) {
                    demand(!kept[t], "the outside is left");
                } else {
                    demand(labels[t] == labels[static_cast<std::size_t>(u)] &&
                               kept[t] == kept[static_cast<std::size_t>(u)],
                           "a region is torn");
                }
            }
    }
}

void check_found(const Case& c, const Expectation& rows, const Definition& expected,
                 const Constrained& found) {
    const bool is_ok = found.status == Status::ok;
    demand(!is_ok || found.unplaced == expected.unplaced, "other edges have no place");
    if (!found.unplaced.empty()) return;
    check_rows(rows, found);
    if (!is_ok) return;
    demand(found.zero_length == expected.zero_length, "other edges have no length");
    demand(found.crossings == expected.crossings, "other edges cross");
    if (!found.crossings.empty()) return;
    demand(check_structure(c, found.result, rows.kept).size() == rows.kept.size(),
           "a position is not a vertex");
    check_pieces(found, expected);
    check_marks(found, expected);
    check_delaunay(c, found.result, found.marks.data());
    check_regions(found);
}

}  // namespace

void check_constraints(Bytes bytes) {
    std::vector<std::uint8_t> ends(2 * (bytes.byte() % (most_edges + 1)));
    for (std::uint8_t& end : ends) end = bytes.byte();
    Case c = decode(bytes);
    if (c.rows() == 0) return;
    std::vector<std::int32_t> edges;
    for (const std::uint8_t end : ends) edges.push_back(static_cast<std::int32_t>(end % c.rows()));
    const Expectation rows = expectation(c);
    Definition expected(c, rows, edges);
    std::sort(expected.crossings.begin(), expected.crossings.end());
    const Constrained found = run(c, edges, c.threads);
    check_found(c, rows, expected, found);
    const Constrained hasty = run(c, edges, c.threads, 1 + c.dice.below(40));
    demand(hasty.status == found.status || hasty.status == Status::interrupted,
           "an interrupted run comes to another status");
    // Backwards and in reverse order they make the same triangles.
    std::reverse(edges.begin(), edges.end());
    const Constrained again = run(c, edges, {});
    demand(again.status == found.status && again.pieces == found.pieces,
           "the order of edges makes other pieces");
    if (found.status == Status::ok && found.crossings.empty() && found.unplaced.empty())
        demand(triangles(again.result) == triangles(found.result),
               "the order of edges makes other triangles");
}

}  // namespace fuzzing
