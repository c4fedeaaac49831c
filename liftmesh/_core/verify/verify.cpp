// What is checked, and why that suffices:
//
// - every triangle turns counter-clockwise;
// - the half-edges are pairs with opposite directions, or belong to the boundary;
// - the boundary is one closed curve that never turns right and winds around once.
//
// Move a point across the plane and count the triangles that cover it. The count changes only where
// the point crosses an edge, and crossing a pair of half-edges does not change it: so it is the
// winding number of the boundary about the point, which is 1 inside and 0 outside. Each triangle
// counts as 1, none as less: so the triangles cover the inside of a convex polygon, and no two
// overlap.
//
// - every row has a vertex at its position: so the polygon is the convex hull of the points;
// - for every interior edge, the apex of one triangle is not inside the circumcircle of the other:
//   so no point is inside the circumcircle of any triangle (Delaunay, 1934).
//
// The canonical test is the same test on lifts that are each perturbed by an infinitesimal. If
// every interior edge passes it, the triangles are the lower hull of the perturbed lifts, which is
// unique: the triangulation is canonical.
//
// For other members of the family, "the lift of the apex of one triangle is not below the plane of
// the other" takes the place of the circle, and a lift may hide rows: a surface without a flaw is
// convex, and every row without a vertex has to be strictly above it (hidden_rows.cpp).
//
// Edges along constraints may fail both: then the triangles are the constrained Delaunay
// triangulation (Lee and Lin, 1986), and among those of the perturbed lifts the only one. That each
// constraint is a union of edges is shown by following it (constraints.cpp). If regions were
// removed, their boundary takes the place of the hull (carving.cpp).
//
// If any triangle is clockwise or degenerate, none of this follows. Then non-manifold edges are
// looked for (`repeated_edges`), and in-circle tests skip those edges and the edges of clockwise or
// degenerate triangles. A list in which every triangle is clockwise is judged as if the corners of
// each were given in the other order.
//
// Several rows may be corners at one position, as in meshes whose triangles share no vertices: if
// the triangles are not connected by their rows, each corner is renamed to the lowest row of its
// position.
//
// Of what decides, only the predicates with their guards and the scaling, whose inverse is checked,
// are shared with the engines.

#include "verify/verify.hpp"

#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/scale.hpp"
#include "sorting/sample.hpp"
#include "verify/constraints.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/sides.hpp"

namespace liftmesh {

namespace {

// Rows that are not finite.
struct Skipped {
    std::size_t count = 0, first = 0;
};

// What pairing the edges finds under the current names of the corners.
struct Findings {
    EdgePairing pairing;
    Boundary boundary;

    bool are_consistent() const {
        return !pairing.triangles.any() && !pairing.boundary.empty() && !boundary.flaws.any();
    }
};

class Verification {
 public:
    Verification(const Input& input, const std::int32_t* simplices, std::size_t count,
                 const Member& member, const Locate& locate, ThreadPool& pool)
        : input_(input),
          simplices_(simplices),
          member_(member),
          locate_(locate),
          pool_(pool),
          points_(allocate<Point>(input.rows)),
          values_(allocate<double>(member.has_values() ? input.rows : 0)),
          corners_(allocate<std::int32_t>(3 * count)),
          mesh_{points_.get(), input.rows, corners_.get(), count, Guard::anywhere()} {}

    Verdict run(bool skip_non_finite) {
        if (!read_points()) return interrupted();
        if (verdict_.skipped > 0 && !skip_non_finite) {
            verdict_.status = Status::non_finite;
            return std::move(verdict_);
        }
        return check() ? std::move(verdict_) : interrupted();
    }

 private:
    static Verdict interrupted() {
        Verdict verdict;
        verdict.status = Status::interrupted;
        return verdict;
    }

    bool check() {
        if (!read_corners()) return false;
        if (verdict_.flaws.any(Flaw::invalid_index)) return true;
        if (mesh_.rows > mesh_.count + 2 && !mark_corners()) return false;
        if (member_.is_constrained() && !mark_corners()) return false;
        if ((needs_positions() || has_too_many_corners()) && !merge_positions()) return false;
        if (!gather_triangles()) return false;
        Findings found;
        if (!check_triangles(found)) return false;
        if (verdict_.flaws.any(Flaw::non_finite)) return true;
        if (!check_edges(found)) return false;
        add_flippable(found.pairing.flippable);
        verdict_.flaws.add(found.boundary.flaws);
        verdict_.interior_edges = found.pairing.interior_edges;
        verdict_.boundary_edges = found.pairing.boundary.size();
        return count_vertices(found);
    }

    bool check_triangles(Findings& found) {
        if (looks_clockwise()) {
            if (!reverse_triangles() || !pair_edges(found)) return false;
            if (none_is_clockwise(found.pairing)) return add_reversed(found.pairing);
            if (!reverse_triangles()) return false;
        }
        if (!pair_edges(found)) return false;
        verdict_.flaws.add(found.pairing.triangles);
        return true;
    }

    // First by the corners as given, then by position. If neither is consistent, edges with several
    // triangles on one side are looked for, so that what is found does not depend on the order of
    // triangles: consistent ones have none.
    bool check_edges(Findings& found) {
        if (!check_boundary(found)) return false;
        if (!found.are_consistent() && !merged_) {
            if (!merge_positions()) return false;
            const bool is_renamed = verdict_.merged > 0 || member_.is_constrained();
            if (is_renamed && !(pair_edges(found) && check_boundary(found))) return false;
        }
        return found.are_consistent() ||
               (mark_corners() &&
                separate_repeated(mesh_, is_corner_, pool_, found.pairing, verdict_.flaws));
    }

    bool pair_edges(Findings& found) {
        found = {};
        if (member_.hides_rows() && !prepare_neighbors()) return false;
        return liftmesh::pair_edges(mesh_, pool_, found.pairing);
    }

    // Rows without a vertex will be located, which takes the neighbours of each triangle.
    bool prepare_neighbors() {
        if (!mark_corners()) return false;
        const auto corners = std::count(is_corner_.begin(), is_corner_.end(), 1);
        if (static_cast<std::size_t>(corners) + verdict_.skipped == mesh_.rows) return true;
        if (neighbors_ == nullptr) neighbors_ = allocate<std::int32_t>(3 * mesh_.count);
        mesh_.neighbors = neighbors_.get();
        return true;
    }

    void add_flippable(const std::vector<FlippableEdge>& edges) {
        for (const FlippableEdge& edge : edges) {
            const auto [low, high] =
                std::minmax({mesh_.callers_place(edge.one), mesh_.callers_place(edge.other)});
            if (edge.not_delaunay) verdict_.flaws.add(Flaw::not_delaunay, {low, high});
            verdict_.flaws.add(Flaw::not_canonical, {low, high});
        }
    }

    bool check_boundary(Findings& found) {
        if (!member_.constraints.are_carved &&
            !liftmesh::check_boundary(mesh_, found.pairing.boundary, pool_, found.boundary))
            return false;
        return !member_.is_constrained() ||
               check_constraints({mesh_, lowest_, is_corner_, found.pairing.boundary, pool_},
                                 member_.constraints, found.pairing, found.boundary.flaws,
                                 verdict_.outside);
    }

    // Calls work(first, last, task) for each block.
    template <class Work>
    bool in_blocks(std::size_t count, Work work) {
        return liftmesh::in_blocks(count, block, pool_, work);
    }

    bool read_points() {
        std::vector<Range> ranges(blocks(input_.rows)), values(ranges.size());
        std::vector<Skipped> skipped(ranges.size());
        const auto read = [&](std::size_t first, std::size_t last, std::size_t task) {
            pool_.interrupt().advance(last - first);
            for (std::size_t row = first; row < last; ++row) {
                const Point p = points_[row] = read_row(row, values[task]);
                if (is_finite(p)) {
                    ranges[task].add(p);
                } else if (skipped[task].count++ == 0) {
                    skipped[task].first = row;
                }
            }
        };
        if (!in_blocks(input_.rows, read)) return false;
        Range range, of_values;
        for (const Range& part : values) of_values.add(part);
        if (member_.has_values()) range = range_of_values(member_, of_values);
        for (const Range& part : ranges) range.add(part);
        for (const Skipped& rows : skipped) {
            if (verdict_.skipped == 0) verdict_.row = rows.first;
            verdict_.skipped += rows.count;
        }
        mesh_.finite = verdict_.skipped == 0;
        const Scale scale(range);
        mesh_.guard = scale.guard;
        if (scale.moves && !apply(scale)) return false;
        sides_ = make_sides(member_, points_.get(), values_.get(), scale.guard);
        mesh_.sides = sides_.get();
        mesh_.values = member_.has_values() ? values_.get() : nullptr;
        return true;
    }

    // A row whose value is not finite counts as one that is not.
    Point read_row(std::size_t row, Range& range) {
        const Point p = input_[row];
        if (!member_.has_values()) return p;
        const double value = values_[row] = member_.values[row];
        if (!std::isfinite(value)) return {value - value, p.y};
        range.add(Pair{value, 0});
        return p;
    }

    // Scales the points, and checks that scaling back restores each of them.
    bool apply(const Scale& scale) {
        std::atomic<bool> lossless = true;
        const bool done = in_blocks(input_.rows, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t row = first; row < last; ++row) {
                const Point p = points_[row];
                const Point moved = points_[row] = scale(p);
                const Point back{moved.x / scale.second / scale.first,
                                 moved.y / scale.second / scale.first};
                if (is_finite(p) && !(back == p && move_value(row, scale))) lossless = false;
            }
        });
        if (!lossless) throw std::logic_error("points that were scaled are not the same points");
        return done;
    }

    bool move_value(std::size_t row, const Scale& scale) {
        if (!member_.has_values()) return true;
        const double value = values_[row];
        const Scale back = scale.inverse();
        return scaled_value(member_, values_[row] = scaled_value(member_, value, scale), back) ==
               value;
    }

    // Copies the corners: from here on no other thread can change them.
    bool read_corners() {
        std::vector<Flaws> found(blocks(mesh_.count));
        const auto read = [&](std::size_t first, std::size_t last, std::size_t task) {
            bool is_wrong = false;
            for (std::size_t place = 3 * first; place < 3 * last; ++place) {
                corners_[place] = simplices_[place];
                is_wrong |= mesh_.corner(place) >= mesh_.rows;
            }
            for (std::size_t place = 3 * first; is_wrong && place < 3 * last; ++place)
                if (mesh_.corner(place) >= mesh_.rows)
                    found[task].add(Flaw::invalid_index, {place, 0});
        };
        const bool done = in_blocks(mesh_.count, read);
        for (const Flaws& part : found) verdict_.flaws.add(part);
        return done;
    }

    // Which rows are corners. A consistent mesh without duplicates needs no such marks.
    bool mark_corners() {
        if (!is_corner_.empty()) return true;
        is_corner_.resize(mesh_.rows);
        return in_blocks(mesh_.count, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t place = 3 * first; place < 3 * last; ++place)
                mark(is_corner_[mesh_.corner(place)]);
        });
    }

    // Safe for several threads. Most bytes are set already, and are only read.
    static void mark(std::uint8_t& byte) {
        const platform::Shared shared(byte);
        if (shared.load() == 0) shared.store(1);
    }

    // Connected triangles without a hole have at most two vertices more than there are triangles.
    // Under the given names these have more.
    bool has_too_many_corners() const {
        if (is_corner_.empty()) return false;
        const auto corners = std::count(is_corner_.begin(), is_corner_.end(), 1);
        return static_cast<std::size_t>(corners) > mesh_.count + 2;
    }

    // Carved triangles may touch at a position of several rows, and constraints end at any of them.
    bool needs_positions() const {
        const Constraints& given = member_.constraints;
        return given.are_carved ||
               std::any_of(given.ends, given.ends + 2 * given.count,
                           [&](std::int32_t row) { return !is_corner_[static_cast<Row>(row)]; });
    }

    bool gather_triangles() {
        Gathered gathered;
        if (!gather(mesh_, pool_, gathered)) return false;
        if (gathered.order == nullptr) return true;
        corners_ = std::move(gathered.simplices);
        order_ = std::move(gathered.order);
        mesh_.simplices = corners_.get();
        mesh_.order = order_.get();
        return true;
    }

    // Whether no triangle of a sample turns counter-clockwise: then perhaps none does.
    bool looks_clockwise() const {
        constexpr std::size_t sample = 64;
        for (std::size_t i = 0; i < sample && mesh_.count > 0; ++i) {
            const std::size_t first = 3 * sample_place(i, mesh_.count);
            const Point a = mesh_.point(first), b = mesh_.point(first + 1);
            const Point c = mesh_.point(first + 2);
            if (!(is_finite(a) && is_finite(b) && is_finite(c)) || orient2d(a, b, c) > 0)
                return false;
        }
        return mesh_.count > 0;
    }

    // Whether none of the reversed triangles turns clockwise, and not all are degenerate.
    bool none_is_clockwise(const EdgePairing& pairing) const {
        return !pairing.triangles.any(Flaw::clockwise) &&
               !pairing.triangles.any(Flaw::non_finite) && pairing.turned.size() < mesh_.count;
    }

    // A mesh oriented to be seen from below is a single mistake: the other flaws are those of the
    // reversed triangles.
    bool add_reversed(const EdgePairing& pairing) {
        std::vector<std::uint8_t> is_degenerate(mesh_.count);
        for (const std::size_t triangle : pairing.turned)
            is_degenerate[mesh_.callers_place(3 * triangle) / 3] = 1;
        for (std::size_t t = 0; t < mesh_.count; ++t)
            verdict_.flaws.add(is_degenerate[t] ? Flaw::degenerate : Flaw::clockwise, {t, 0});
        return true;
    }

    bool reverse_triangles() {
        mesh_.reversed = !mesh_.reversed;
        return in_blocks(mesh_.count, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t t = first; t < last; ++t)
                std::swap(corners_[3 * t + 1], corners_[3 * t + 2]);
        });
    }

    // Renames each corner to the lowest row of its position.
    bool merge_positions() {
        merged_ = true;
        if (!mark_corners() || !find_lowest(mesh_, pool_, lowest_)) return false;
        Marks kept(mesh_.rows);
        for (std::size_t row = 0; row < mesh_.rows; ++row)
            if (is_corner_[row]) verdict_.merged += std::exchange(kept[lowest_[row]], 1);
        if (verdict_.merged == 0 && !member_.is_constrained()) return true;
        is_corner_ = std::move(kept);
        return in_blocks(mesh_.count, [&](std::size_t first, std::size_t last, auto) {
            for (std::size_t place = 3 * first; place < 3 * last; ++place)
                corners_[place] = static_cast<std::int32_t>(lowest_[mesh_.corner(place)]);
        });
    }

    // Where no two triangles overlap, one of those at each inner vertex covers the direction
    // upwards (`repeated_edges.cpp`), and the boundary knows at which of its vertices one does: if
    // that many vertices are all rows, none is missing.
    bool count_vertices(const Findings& found) {
        const std::size_t covered = found.pairing.covering + found.boundary.uncovered;
        const bool is_whole = !member_.constraints.are_carved && found.are_consistent();
        if (is_whole && covered + verdict_.skipped == mesh_.rows) {
            verdict_.vertices = covered;
            return true;
        }
        if (!mark_corners()) return false;
        for (const std::uint8_t corner : is_corner_) verdict_.vertices += corner;
        if (member_.constraints.are_carved) return true;
        if (member_.hides_rows())
            return has_flaws() ||
                   judge_others(mesh_, is_corner_, locate_, pool_, verdict_.hidden, verdict_.flaws);
        return verdict_.vertices + verdict_.merged + verdict_.skipped == mesh_.rows ||
               find_missing(mesh_, is_corner_, pool_, verdict_.flaws);
    }

    // Others than those of ties.
    bool has_flaws() const {
        for (std::size_t i = 0; i < static_cast<std::size_t>(Flaw::kinds); ++i) {
            const auto flaw = static_cast<Flaw>(i);
            if (flaw != Flaw::not_canonical && verdict_.flaws.any(flaw)) return true;
        }
        return mesh_.count == 0;
    }

    const Input& input_;
    const std::int32_t* simplices_;
    const Member& member_;
    const Locate& locate_;
    ThreadPool& pool_;
    Buffer<Point> points_;
    Buffer<double> values_;  // if the member has values
    std::unique_ptr<Sides> sides_;
    Buffer<std::int32_t> corners_;
    Buffer<std::uint32_t> order_;
    Buffer<std::int32_t> neighbors_;  // if there are rows without a vertex, of lifts that hide
    MeshView mesh_;
    Marks is_corner_;
    std::vector<Row> lowest_;  // of each row: the lowest at its position
    bool merged_ = false;      // each corner is the lowest row of its position
    Verdict verdict_;
};

}  // namespace

Verdict verify(const Input& input, const std::int32_t* simplices, std::size_t count,
               bool skip_non_finite, const Member& member, const Locate& locate, Threads threads,
               Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(std::max(input.rows, count)), interrupt);
    interrupt.expect(input.rows + 3 * count);
    return Verification(input, simplices, count, member, locate, pool).run(skip_non_finite);
}

}  // namespace liftmesh
