// Domains between edges are refined as the bytes say, to an angle, an area and a number of rows,
// and smoothed: the verifier accepts the triangles, and what they are said to be, they are.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "bounded.hpp"
#include "checks.hpp"
#include "constrained/regions.hpp"
#include "demand.hpp"
#include "refinement/refine.hpp"
#include "targets.hpp"
#include "verify/verify.hpp"

namespace fuzzing {

namespace {

using liftmesh::Constrained;
using liftmesh::Input;
using liftmesh::Status;
using liftmesh::constrained::Piece;
using liftmesh::refinement::Cause;
using liftmesh::refinement::no_piece;
using liftmesh::refinement::Refined;
using liftmesh::refinement::Wanted;

constexpr std::size_t most_edges = 32, most_regions = 8, most_rounds = 4;
constexpr double widest = 40;  // degrees

std::vector<std::int32_t> regions(const Constrained& mesh, unsigned outside) {
    std::vector<std::int32_t> labels = liftmesh::constrained::label(
        {mesh.result.neighbors.get(), mesh.marks.data(), mesh.result.triangle_count});
    for (std::int32_t& label : labels)
        if (outside >> (static_cast<unsigned>(label) % most_regions) & 1) label = -1;
    return labels;
}

std::vector<Piece> marked(const Refined& found) {
    std::vector<Piece> sides;
    for (std::size_t t = 0; t < found.result.triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k)
            if (found.marks[t] >> k & 1) sides.push_back(native::side(found.result, t, k));
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    return sides;
}

void check_verdict(const Case& c, const Refined& found, const std::vector<Piece>& sides) {
    std::vector<Point> points;
    for (std::size_t row = 0; row < c.rows(); ++row) points.push_back(c.point(row));
    points.insert(points.end(), found.added.begin(), found.added.end());
    const Input input{reinterpret_cast<const std::byte*>(points.data()), points.size(),
                      sizeof(Point), sizeof(double), false};
    liftmesh::Member member{liftmesh::Member::Kind::constrained};
    std::vector<std::int32_t> ends;
    for (const Piece& each : sides) {
        ends.push_back(static_cast<std::int32_t>(each.first));
        ends.push_back(static_cast<std::int32_t>(each.second));
    }
    member.constraints = {ends.data(), sides.size(), true};
    Impatient interrupt;
    const auto verdict =
        liftmesh::verify(input, found.result.simplices.get(), found.result.triangle_count,
                         c.skip_non_finite, member, {}, {}, interrupt);
    demand(verdict.status == Status::ok && !verdict.flaws.any(), "the verifier rejects triangles");
}

// Every row that divides a piece makes one part more of it.
void check_parts(const Constrained& before, const Refined& found, const std::vector<Piece>& sides) {
    demand(found.divided.size() == found.added.size(), "rows that divide nothing are not told");
    std::size_t parts = before.pieces.size();
    for (const std::int32_t piece : found.divided) {
        demand(piece >= no_piece && piece < static_cast<std::int32_t>(before.pieces.size()),
               "a row divides what there is not");
        parts += piece != no_piece;
    }
    demand(sides.size() == parts, "parts are lost");
}

void check_regions(const Refined& found) {
    for (std::size_t t = 0; t < found.result.triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k) {
            const std::int32_t u = found.result.neighbors[3 * t + k];
            if (found.marks[t] >> k & 1) continue;
            const std::int32_t beyond = u < 0 ? -1 : found.regions[static_cast<std::size_t>(u)];
            demand(found.regions[t] == beyond, "a region is torn");
        }
}

void check_causes(const Wanted& wanted, const Refined& found) {
    demand(found.added.size() <= wanted.most, "more rows are added than there may be");
    for (std::size_t t = 0; t < found.result.triangle_count; ++t) {
        demand(found.causes[t] != Cause::cap || found.is_capped, "there was no cap");
        demand(found.causes[t] == Cause::none || found.regions[t] >= 0, "a cause outside");
        demand(!found.is_large[t] || (found.regions[t] >= 0 && !wanted.largest.empty()),
               "a triangle is too large for no bound");
    }
}

// Only rows between constraints may have moved.
void check_smoothed(const Refined& before, const Refined& found) {
    demand(found.divided == before.divided, "other rows are added");
    for (std::size_t i = 0; i < found.added.size(); ++i)
        demand(found.divided[i] == no_piece || found.added[i] == before.added[i], "a part moved");
}

}  // namespace

void check_refinement(Bytes bytes) {
    const double angle = widest * bytes.byte() / 255;
    const std::uint8_t how = bytes.byte();
    const std::uint8_t amount = bytes.byte();
    const unsigned outside = bytes.byte();
    std::vector<std::uint8_t> ends(2 * (bytes.byte() % (most_edges + 1)));
    for (std::uint8_t& end : ends) end = bytes.byte();
    Case c = decode(bytes);
    if (c.rows() == 0 || c.is_large()) return;
    std::vector<std::int32_t> edges;
    for (const std::uint8_t end : ends) edges.push_back(static_cast<std::int32_t>(end % c.rows()));
    Impatient patient;
    Constrained mesh = liftmesh::constrained_delaunay(c.input, edges.data(), edges.size() / 2,
                                                      c.skip_non_finite, {}, patient);
    if (mesh.status != Status::ok || !mesh.crossings.empty() || !mesh.unplaced.empty()) return;
    native::bound(mesh);
    const std::vector<std::int32_t> labels = regions(mesh, outside);
    const std::vector<double> largest(mesh.result.triangle_count,
                                      std::ldexp(1.0, how / 4 * 32 - 1000));
    const double cosine = angle > 0 ? std::cos(angle * std::numbers::pi / 180) : 1;
    Wanted wanted{cosine, {}, {}, (how & 1) != 0, 2 * std::size_t{amount}, amount % most_rounds};
    if (how & 2) wanted.largest = largest;
    const Refined found = liftmesh::refinement::refine({c.input, mesh, labels}, wanted, patient);
    demand(found.status == Status::ok, "the refinement has another status");
    const std::vector<Piece> sides = marked(found);
    check_verdict(c, found, sides);
    check_parts(mesh, found, sides);
    check_regions(found);
    check_causes(wanted, found);
    if (wanted.rounds == 0) return;
    wanted.rounds = 0;
    check_smoothed(liftmesh::refinement::refine({c.input, mesh, labels}, wanted, patient), found);
}

}  // namespace fuzzing
