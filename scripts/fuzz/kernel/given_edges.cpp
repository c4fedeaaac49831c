// Edges between rows as the bytes say: what they become is what trying all pairs tells, by integers
// of any length, and every other edge of the triangulation is canonical. The verifier accepts it,
// whole or carved, and of damaged ones those that carving could have left.
#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

#include "checks.hpp"
#include "constrained/regions.hpp"
#include "demand.hpp"
#include "exact.hpp"
#include "targets.hpp"
#include "verify/verify.hpp"

namespace fuzzing {

namespace {

using liftmesh::Constrained;
using liftmesh::Row;
using liftmesh::Status;
using liftmesh::constrained::Carving;
using liftmesh::constrained::Crossing;
using liftmesh::constrained::EdgeId;
using liftmesh::constrained::Piece;
using Edges = std::vector<std::int32_t>;

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
    Definition(const Case& c, const Expectation& expected, const Edges& edges)
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

    // How many finite rows are at no corner.
    std::size_t outside(const Corners& corners) const {
        const std::set<std::int32_t> rows(corners.begin(), corners.end());
        return static_cast<std::size_t>(std::count_if(row_of_.begin(), row_of_.end(), [&](Row row) {
            return row != nowhere && !rows.contains(static_cast<std::int32_t>(row));
        }));
    }

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

Constrained run(const Case& c, const Edges& edges, liftmesh::Threads threads,
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
    const std::vector<std::int32_t> none(2 * found.pieces.size());
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

liftmesh::Verdict verdict(const Case& c, const Edges& edges, const Corners& corners, bool carved,
                          std::size_t patience = ~std::size_t{0}) {
    Impatient interrupt(patience);
    const liftmesh::Member member{
        liftmesh::Member::Kind::constrained, nullptr, {}, {edges.data(), edges.size() / 2, carved}};
    return liftmesh::verify(c.input, corners.data(), corners.size() / 3, c.skip_non_finite, member,
                            {}, c.threads, interrupt);
}

// Each with its least row first.
std::vector<Triangle> sorted(const Corners& corners) {
    std::vector<Triangle> found;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        Triangle each{corners[i], corners[i + 1], corners[i + 2]};
        std::rotate(each.begin(), std::min_element(each.begin(), each.end()), each.end());
        found.push_back(each);
    }
    std::sort(found.begin(), found.end());
    return found;
}

std::set<std::pair<std::int32_t, std::int32_t>> sides_of(const std::vector<Triangle>& triangles) {
    std::set<std::pair<std::int32_t, std::int32_t>> sides;
    for (const auto [a, b, c] : triangles) sides.insert({{a, b}, {b, c}, {c, a}});
    return sides;
}

// Whether triangles are some of all, and end where constraints or all of them end.
bool are_part(const std::vector<Triangle>& all, const Definition& expected,
              const Corners& corners) {
    const std::vector<Triangle> these = sorted(corners);
    const bool is_set = std::adjacent_find(these.begin(), these.end()) == these.end();
    if (!is_set || !std::includes(all.begin(), all.end(), these.begin(), these.end())) return false;
    const auto sides = sides_of(these), known = sides_of(all);
    return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
        const std::pair other(side.second, side.first);
        return sides.contains(other) || !known.contains(other) ||
               expected.has(static_cast<Row>(side.first), static_cast<Row>(side.second));
    });
}

void check_verdicts(const Case& c, const Definition& expected, const Edges& edges,
                    const std::vector<Triangle>& all, const Corners& corners) {
    const bool is_part = are_part(all, expected, corners), is_whole = sorted(corners) == all;
    demand(verdict(c, edges, corners, false).flaws.any() != is_whole,
           "the verifier takes triangles with constraints for others");
    const liftmesh::Verdict carved = verdict(c, edges, corners, true);
    demand(carved.status == Status::ok && carved.flaws.any() != is_part,
           "the verifier takes carved triangles for others");
    demand(!is_part || carved.outside == expected.outside(corners), "other rows are outside");
}

// What is left of some triangles.
Corners kept_of(const Constrained& found, const std::vector<std::uint8_t>& kept, Corners corners) {
    Corners gone, left;
    for (std::size_t t = 0; t < kept.size(); ++t)
        if (!kept[t])
            gone.insert(gone.end(), &found.result.simplices[3 * t],
                        &found.result.simplices[3 * t] + 3);
    const std::vector<Triangle> removed = sorted(gone);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const auto first = corners.begin() + static_cast<std::ptrdiff_t>(i);
        const Triangle each = sorted(Corners(first, first + 3)).front();
        if (!std::binary_search(removed.begin(), removed.end(), each))
            left.insert(left.end(), first, first + 3);
    }
    return left;
}

// Some pieces bound regions; some are sides of polygons, of which none needs to be closed.
std::vector<std::uint8_t> carved(Case& c, const Constrained& found) {
    std::vector<std::uint8_t> bounds;
    std::vector<std::int32_t> winding;
    const bool has_polygons = c.dice.below(3) == 0;
    for (std::size_t i = 0; i < found.pieces.size(); ++i) {
        bounds.push_back(c.dice.below(8) != 0);
        for (int ring = 0; ring < 2; ++ring)
            winding.push_back(has_polygons ? static_cast<std::int32_t>(c.dice.below(3)) - 1 : 0);
    }
    std::vector<std::int32_t> seeds;
    if (c.dice.below(2) == 0)
        seeds.push_back(static_cast<std::int32_t>(c.dice.below(found.result.triangle_count)));
    const auto carving = static_cast<Carving>(c.dice.below(3));
    return liftmesh::constrained::carve(
        {found.result.neighbors.get(), found.marks.data(), found.result.triangle_count},
        found.result.simplices.get(), {found.pieces, bounds.data(), winding.data()}, carving,
        seeds);
}

void check_verified(Case& c, const Definition& expected, const Edges& edges,
                    const Constrained& found) {
    const std::vector<Triangle> all = triangles(found.result);
    const std::int32_t* const simplices = found.result.simplices.get();
    const Corners whole(simplices, simplices + 3 * found.result.triangle_count);
    for (int round = 0; round < 4; ++round) {
        Corners corners = whole;
        if (round > 1) damage(c, found, corners);
        if (round > 0) corners = kept_of(found, carved(c, found), corners);
        check_verdicts(c, expected, edges, all, corners);
    }
    verdict(c, edges, whole, true, 1 + c.dice.below(40));
}

void check_found(Case& c, const Expectation& rows, const Definition& expected, const Edges& edges,
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
    check_verified(c, expected, edges, found);
}

}  // namespace

void check_constraints(Bytes bytes) {
    std::vector<std::uint8_t> ends(2 * (bytes.byte() % (most_edges + 1)));
    for (std::uint8_t& end : ends) end = bytes.byte();
    Case c = decode(bytes);
    if (c.rows() == 0) return;
    Edges edges;
    for (const std::uint8_t end : ends) edges.push_back(static_cast<std::int32_t>(end % c.rows()));
    const Expectation rows = expectation(c);
    Definition expected(c, rows, edges);
    std::sort(expected.crossings.begin(), expected.crossings.end());
    const Constrained found = run(c, edges, c.threads);
    check_found(c, rows, expected, edges, found);
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
