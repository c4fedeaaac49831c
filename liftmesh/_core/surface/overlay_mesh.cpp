#include "surface/overlay_mesh.hpp"

#include "base/floating_point.hpp"
#include "predicates/crossings.hpp"
#include "predicates/scale.hpp"
#include "sorting/patient_sort.hpp"
#include "surface/pieces.hpp"

namespace liftmesh {

namespace {

// Coordinates in decimals are off by half a unit each, so that turns of three on a line in decimals
// are zero within one; what has been computed once more, within two.
constexpr double few_units = 2;

// How near counts as on a side; and whether units are those of the largest coordinate, and faces
// that are flat within them are left out.
struct Attempt {
    double units;
    bool is_wide;
};
constexpr Attempt attempts[] = {{few_units, false},
                                {0, false},
                                {few_units, true},
                                {8 * few_units, true},
                                {64 * few_units, true}};

// A side of a triangle, three times its number and the corner opposite.
using OverlaySide = std::uint32_t;

class Overlaid {
 public:
    Overlaid(const std::array<LocalSurface, 2>& surfaces, const Pieces& pieces, OverlayMesh& found,
             Interrupt& interrupt)
        : surfaces_(surfaces),
          pieces_(pieces),
          found_(found),
          interrupt_(interrupt),
          patience_(interrupt) {}

    // False if the interrupt came first, or the result is not sound.
    bool run() {
        return advanced(name_corners(), 2) && advanced(place_rows(), 3) &&
               advanced(triangulate(), 1) && link();
    }

 private:
    bool advanced(bool is_done, std::size_t tenths) {
        interrupt_.advance(tenths * surfaces_[0].count());
        return is_done;
    }

    bool unsound() {
        found_.is_sound = false;
        return false;
    }

    std::int32_t face_of(const OverlayPiece& piece, std::size_t surface) const {
        return surface == 0 ? piece.face : piece.other;
    }

    // Whether pieces of one face of a surface come before those of another one.
    bool is_before(std::size_t surface, std::int32_t one, std::int32_t two) const {
        return surface == 0 ? pieces_.before(one, two) : one < two;
    }

    // Which corner of a piece is the crossing of the same sides as in another one; `count` if none.
    std::size_t crossing_in(const OverlayPiece& piece, const std::array<std::int32_t, 2>& from,
                            const std::array<std::size_t, 2>& sides) const {
        std::array<std::size_t, 2> own = sides;
        for (std::size_t f : {0, 1}) {
            const std::int32_t face = face_of(piece, f);
            if (face == from[f]) continue;
            own[f] = 0;
            while (own[f] < 3 && surfaces_[f].neighbor(face, own[f]) != from[f]) ++own[f];
            if (own[f] == 3) return piece.count;
        }
        const PieceCorner sought = PieceCorner::crossing(own[0], own[1]);
        for (std::size_t i = 0; i < piece.count; ++i)
            if (piece.corners[i].same_place(sought)) return i;
        return piece.count;
    }

    // A number for each corner: vertices of the first surface, then of the second, then crossings
    // as they are first met, in the piece of the earlier of both faces at each side.
    bool name_corners() {
        const std::size_t first = surfaces_[0].vertices(), all = first + surfaces_[1].vertices();
        names_ = allocate<std::int32_t>(pieces_.corners);
        is_used_.assign(all, 0);
        crossings_.reserve(pieces_.pieces.size());
        for (const OverlayPiece& piece : pieces_.pieces) {
            if (patience_.ends()) return false;
            for (std::size_t i = 0; i < piece.count; ++i) {
                const PieceCorner corner = piece.corners[i];
                if (corner.is_crossing()) {
                    if (!name_crossing(piece, i, all)) return unsound();
                    continue;
                }
                const std::int32_t vertex =
                    surfaces_[corner.face()].vertex(face_of(piece, corner.face()), corner.k());
                std::int32_t& name = names_[piece.first + i];
                name = corner.face() == 0 ? vertex : vertex + static_cast<std::int32_t>(first);
                is_used_[static_cast<std::size_t>(name)] = 1;
            }
        }
        return true;
    }

    bool name_crossing(const OverlayPiece& piece, std::size_t i, std::size_t before) {
        const PieceCorner corner = piece.corners[i];
        const std::array<std::size_t, 2> sides{corner.side(0), corner.side(1)};
        const std::array<std::int32_t, 2> from{piece.face, piece.other};
        std::array<std::int32_t, 2> owner = from;
        for (std::size_t f : {0, 1}) {
            const std::int32_t beyond = surfaces_[f].shown_neighbor(from[f], sides[f]);
            if (beyond >= 0 && is_before(f, beyond, from[f])) owner[f] = beyond;
        }
        std::int32_t& name = names_[piece.first + i];
        if (owner == from) {
            name = static_cast<std::int32_t>(before + crossings_.size());
            const auto [p, q] = ends_of(piece, 0, sides[0]);
            const auto [r, t] = ends_of(piece, 1, sides[1]);
            crossings_.push_back({p, q, r, t});
            return before + crossings_.size() < most_numbers;
        }
        const OverlayPiece* const known = pieces_.find(owner[0], owner[1]);
        if (!known) return false;
        const std::size_t place = crossing_in(*known, from, sides);
        if (place == known->count) return false;
        name = names_[known->first + place];
        return true;
    }

    // The lesser and the greater end of a side.
    std::pair<std::int32_t, std::int32_t> ends_of(const OverlayPiece& piece, std::size_t surface,
                                                  std::size_t side) const {
        const LocalSurface& of = surfaces_[surface];
        const std::int32_t face = face_of(piece, surface), tail = of.vertex(face, tail_of(side)),
                           head = of.vertex(face, head_of(side));
        if (before_xy(of.corner(head).at, of.corner(tail).at)) return {head, tail};
        return {tail, head};
    }

    // Two sides, from the lesser end of each.
    struct Crossing {
        std::array<std::int32_t, 4> ends;
        const SurfaceCorner& end(const std::array<LocalSurface, 2>& surfaces, std::size_t i) const {
            return surfaces[i / 2].corner(ends[i]);
        }
    };

    bool place_rows() {
        const std::size_t first = surfaces_[0].vertices(), all = is_used_.size();
        std::vector<Site> sites;
        sites.reserve(all + crossings_.size());
        places_ = allocate<Point>(all + crossings_.size());
        for (std::size_t name = 0; name < all; ++name) places_[name] = vertex(name, first).at;
        for (const auto& [name, place] : pieces_.moved)
            places_[static_cast<std::size_t>(name)] = place;
        for (std::size_t name = 0; name < all; ++name) {
            if (!is_used_[name]) continue;
            if (!is_finite(places_[name])) return unsound();
            sites.push_back({places_[name], static_cast<Row>(name)});
        }
        const Buffer<double> rises = allocate<double>(crossings_.size());
        for (std::size_t i = 0; i < crossings_.size(); ++i) {
            if (patience_.ends()) return false;
            const Point place = place_of(crossings_[i]);
            if (!is_finite(place)) return unsound();
            places_[all + i] = place;
            rises[i] = rise_at(crossings_[i], place);
            sites.push_back({place, static_cast<Row>(all + i)});
        }
        const auto is_less = [](const Site& a, const Site& b) {
            return before_xy(a.point, b.point);
        };
        if (!patient_sort(sites, is_less, interrupt_)) return false;
        found_.rows = sites.size();
        found_.crossings = crossings_.size();
        found_.points = allocate<Point>(sites.size());
        found_.rises = allocate<double>(sites.size());
        rows_.resize(all + crossings_.size());
        Range range;
        for (std::size_t row = 0; row < sites.size(); ++row) {
            if (patience_.ends()) return false;
            const auto [place, name] = sites[row];
            if (row > 0 && place == sites[row - 1].point) return unsound();
            range.add(place);
            found_.points[row] = place;
            found_.rises[row] = name < all ? rise_at(name, first) : rises[name - all];
            rows_[name] = static_cast<std::int32_t>(row);
        }
        const Scale scale(range);
        guard_ = scale.moves ? Guard::anywhere() : scale.guard;
        return true;
    }

    const SurfaceCorner& vertex(std::size_t name, std::size_t first) const {
        return name < first ? surfaces_[0].corner(static_cast<std::int32_t>(name))
                            : surfaces_[1].corner(static_cast<std::int32_t>(name - first));
    }

    double rise_at(std::size_t name, std::size_t first) const {
        const double own = vertex(name, first).height;
        return name < first ? own - pieces_.heights[0][name]
                            : pieces_.heights[1][name - first] - own;
    }

    double rise_at(const Crossing& crossing, Point place) const {
        const auto height = [&](std::size_t i) {
            return height_along(crossing.end(surfaces_, i), crossing.end(surfaces_, i + 1), place);
        };
        return height(0) - height(2);
    }

    // From the lesser of both sides, so that it is the same where the surfaces are exchanged.
    Point place_of(const Crossing& crossing) {
        std::array<Point, 4> ends;
        for (std::size_t i = 0; i < 4; ++i) ends[i] = crossing.end(surfaces_, i).at;
        const std::size_t later = ends[0] == ends[2] ? 1 : 0;
        if (before_xy(ends[2 + later], ends[later])) {
            std::swap(ends[0], ends[2]);
            std::swap(ends[1], ends[3]);
        }
        const auto [place, residual] = crossing_of(&ends[0].x);
        constexpr double diagonal = 1.5;  // at least the root of 2
        if (diagonal * std::max(std::fabs(residual.x), std::fabs(residual.y)) > found_.displacement)
            for (const std::size_t i : {0, 2}) add_displacement(residual, ends[i], ends[i + 1]);
        return place;
    }

    void add_displacement(Point residual, Point tail, Point head) {
        const double x = head.x - tail.x, y = head.y - tail.y, length = std::hypot(x, y);
        const double across = residual.x * (y / length) - residual.y * (x / length);
        found_.displacement = std::max(found_.displacement, std::fabs(across));
    }

    // The triangles of each piece, and which of them has each of its sides.
    bool triangulate() {
        const std::size_t count = pieces_.corners - 2 * pieces_.pieces.size();
        if (count >= most_numbers / 3) return unsound();
        found_.triangles = count;
        found_.simplices = allocate<std::int32_t>(3 * count);
        found_.neighbors = allocate<std::int32_t>(3 * count);
        found_.bits = allocate<std::uint8_t>(count);
        std::fill_n(found_.bits.get(), count, std::uint8_t{0});
        std::fill_n(found_.neighbors.get(), 3 * count, unlinked);
        sides_ = allocate<OverlaySide>(pieces_.corners);
        next_ = 0;
        for (const OverlayPiece& piece : pieces_.pieces) {
            if (patience_.ends()) return false;
            const std::size_t n = piece.count;
            const std::int32_t* const rows = names_.get() + piece.first;
            for (std::size_t i = 0; i < n; ++i)
                if (orient2d(at(rows[i]), at(rows[(i + 1) % n]), at(rows[(i + 2) % n])) <= 0)
                    return unsound();
            sides_[piece.first + n - 1] = divide(piece, 0, n - 1);
        }
        return true;
    }

    // What is between two corners of a piece, seen from the chord: the Delaunay triangle at that,
    // and what is beyond it. Returns where the chord is.
    OverlaySide divide(const OverlayPiece& piece, std::size_t i, std::size_t j) {
        const std::int32_t* const rows = names_.get() + piece.first;
        std::size_t apex = i + 1;
        for (std::size_t m = i + 2; m < j; ++m)
            if (is_inside(rows[i], rows[apex], rows[j], rows[m])) apex = m;
        const std::size_t t = next_++;
        std::int32_t* const corners = found_.simplices.get() + 3 * t;
        corners[0] = rows[i];
        corners[1] = rows[apex];
        corners[2] = rows[j];
        const auto sides = static_cast<OverlaySide>(3 * t);
        join_within(piece, sides + 2, i, apex);
        join_within(piece, sides, apex, j);
        return sides + 1;
    }

    void join_within(const OverlayPiece& piece, OverlaySide side, std::size_t i, std::size_t j) {
        if (i + 1 == j)
            sides_[piece.first + i] = side;
        else
            join(side, divide(piece, i, j));
    }

    void join(OverlaySide one, OverlaySide other) {
        found_.neighbors[one] = static_cast<std::int32_t>(other / 3);
        found_.neighbors[other] = static_cast<std::int32_t>(one / 3);
    }

    bool link() {
        for (const OverlayPiece& piece : pieces_.pieces) {
            if (patience_.ends()) return false;
            for (std::size_t i = 0; i < piece.count; ++i)
                if (!link_side(piece, i)) return unsound();
        }
        for (std::size_t i = 0; i < 3 * found_.triangles; ++i)
            found_.simplices[i] = rows_[static_cast<std::size_t>(found_.simplices[i])];
        const std::int32_t* const all = found_.neighbors.get();
        return std::find(all, all + 3 * found_.triangles, unlinked) == all + 3 * found_.triangles ||
               unsound();
    }

    // The triangles on both sides of a side of a piece.
    bool link_side(const OverlayPiece& piece, std::size_t i) {
        const OverlaySide own = sides_[piece.first + i];
        std::array<std::int32_t, 2> beyond{piece.face, piece.other};
        for (std::size_t f : {0, 1}) {
            const std::size_t side = piece.corners[i].next_side(f);
            if (side != PieceCorner::no_side)
                beyond[f] = surfaces_[f].shown_neighbor(beyond[f], side);
        }
        if (beyond[0] < 0 || beyond[1] < 0) {
            found_.neighbors[own] = -1;
            mark(own);
            return true;
        }
        const bool is_same = beyond[0] == piece.face;
        if (is_before(is_same, beyond[is_same], face_of(piece, is_same))) return true;
        const OverlayPiece* const next = pieces_.find(beyond[0], beyond[1]);
        if (!next) return false;
        const std::size_t n = piece.count, m = next->count;
        const std::int32_t tail = names_[piece.first + i], head = names_[piece.first + (i + 1) % n];
        const std::int32_t* const rows = names_.get() + next->first;
        for (std::size_t j = 0; j < m; ++j) {
            if (rows[j] != head || rows[j + 1 == m ? 0 : j + 1] != tail) continue;
            const OverlaySide other = sides_[next->first + j];
            join(own, other);
            if (needs_constraint(own, other)) {
                mark(own);
                mark(other);
            }
            return true;
        }
        return false;
    }

    void mark(OverlaySide side) {
        found_.bits[side / 3] |= static_cast<std::uint8_t>(1u << side % 3);
    }

    // Whether the corner of a triangle beyond a side is in the circle of the triangle before it.
    bool needs_constraint(OverlaySide one, OverlaySide other) const {
        const std::int32_t* const corners = found_.simplices.get() + 3 * (one / 3);
        return is_inside(corners[0], corners[1], corners[2], found_.simplices[other]);
    }
    bool is_inside(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) const {
        return incircle_canonical(at(a), at(b), at(c), at(d), guard_);
    }
    Point at(std::int32_t name) const { return places_[static_cast<std::size_t>(name)]; }

    static constexpr std::size_t most_numbers = 0x7fffffff;
    static constexpr std::int32_t unlinked = -2;

    const std::array<LocalSurface, 2>& surfaces_;
    const Pieces& pieces_;
    OverlayMesh& found_;
    Interrupt& interrupt_;
    Patience patience_;
    Buffer<std::int32_t> names_;  // of the corners of all pieces
    Buffer<Point> places_;        // of each name
    Buffer<OverlaySide> sides_;   // from each corner on
    std::vector<std::uint8_t> is_used_;
    std::vector<Crossing> crossings_;
    std::vector<std::int32_t> rows_;  // of each name
    std::size_t next_ = 0;
    Guard guard_ = Guard::in_window();
};

}  // namespace

bool overlay_mesh(const Relief& first, const Relief& second, std::int32_t face, std::int32_t other,
                  OverlayMesh& found, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    std::array<LocalSurface, 2> surfaces;
    if (!surfaces[0].read(first, interrupt) || !surfaces[1].read(second, interrupt)) return false;
    std::int32_t faces[] = {surfaces[0].named(face), surfaces[1].named(other)};
    const bool is_turned = surfaces[1].is_before(surfaces[0]);  // either way gives the same
    if (is_turned) {
        std::swap(surfaces[0], surfaces[1]);
        std::swap(faces[0], faces[1]);
    }
    interrupt.expect(10 * surfaces[0].count());
    interrupt.advance(surfaces[0].count());
    const double largest = std::max(surfaces[0].largest(), surfaces[1].largest());
    for (const auto [units, is_wide] : attempts) {
        const Nearness nearness{units, largest, is_wide ? largest : 0};
        found = {};
        if (is_wide)
            for (LocalSurface& surface : surfaces) surface.hide_flat(nearness);
        Pieces pieces;
        if (!find_pieces(surfaces, faces[0], faces[1], nearness, pieces, interrupt)) return false;
        found.displacement = pieces.displacement;
        found.is_sound = pieces.is_sound;
        if (!found.is_sound) continue;
        if (Overlaid(surfaces, pieces, found, interrupt).run()) break;
        if (found.is_sound) return false;
    }
    if (is_turned && found.is_sound)
        for (std::size_t row = 0; row < found.rows; ++row) found.rises[row] = 0 - found.rises[row];
    return true;
}

}  // namespace liftmesh
