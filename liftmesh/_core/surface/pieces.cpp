#include "surface/pieces.hpp"

#include "predicates/crossings.hpp"
#include "surface/flood.hpp"

namespace liftmesh {

namespace {

// The sides of a face on which a corner of the other one is.
unsigned sides_at(const FacePair& pair, std::size_t face, std::size_t corner) {
    unsigned sides = 0;
    for (std::size_t side = 0; side < 3; ++side)
        sides |= static_cast<unsigned>(pair.turn_about(face, side, corner).value == 0) << side;
    return sides;
}

constexpr unsigned sides_of_corner(std::size_t k) {
    return 7u & ~(1u << k);
}

constexpr std::size_t side_in(unsigned sides) {
    return sides == 0 ? PieceCorner::no_side : static_cast<std::size_t>(std::countr_zero(sides));
}

// Whether corners near to the same sides are at one place, and not along two that hardly diverge.
bool are_together(Point p, Point q, Nearness nearness) {
    constexpr double unit = 0x1p-52, more = 8;
    const auto is_near = [nearness](double a, double b) {
        return std::fabs(a - b) <= more * nearness.units * unit *
                                       std::max({std::fabs(a), std::fabs(b), nearness.least});
    };
    return is_near(p.x, q.x) && is_near(p.y, q.y);
}

PieceCorner corner_at(const FacePair& pair, std::size_t face, std::size_t k) {
    if (face == 1)
        for (std::size_t i = 0; i < 3; ++i)
            if (sides_at(pair, 0, k) == sides_of_corner(i) &&
                are_together(pair.face(0).at(i), pair.face(1).at(k), pair.nearness()))
                return PieceCorner::at(0, i);
    return PieceCorner::at(face, k);
}

// Where a corner of the moved outline goes.
PieceCorner limit(const FacePair& pair, const FacePair::Corner& corner) {
    if (!corner.is_crossing) return corner_at(pair, corner.face, corner.k);
    const std::size_t side = corner.k, other = corner.other;
    for (const std::size_t end : {tail_of(side), head_of(side)})
        if (pair.turn_about(1, other, end).value == 0) return corner_at(pair, 0, end);
    for (const std::size_t end : {tail_of(other), head_of(other)})
        if (pair.turn_about(0, side, end).value == 0) return corner_at(pair, 1, end);
    return PieceCorner::crossing(side, other);
}

// The sides of a face on which a corner of a piece is.
unsigned sides_with(const FacePair& pair, std::size_t face, PieceCorner corner) {
    if (corner.is_crossing()) return 1u << corner.side(face);
    return corner.face() == face ? sides_of_corner(corner.k()) : sides_at(pair, face, corner.k());
}

}  // namespace

bool outline_of(const FacePair& pair, OverlayPiece& piece) {
    const FacePair::Outline outline = pair.outline();
    std::size_t count = 0;
    for (std::size_t i = 0; i < outline.count; ++i) {
        const PieceCorner corner = limit(pair, outline.corners[i]);
        if (count > 0 && piece.corners[count - 1].same_place(corner)) continue;
        if (count == OverlayPiece::most) {
            if (corner.same_place(piece.corners[0])) continue;
            return false;
        }
        piece.corners[count++] = corner;
    }
    if (count > 1 && piece.corners[count - 1].same_place(piece.corners[0])) --count;
    if (count < 3) return false;
    piece.count = static_cast<std::uint8_t>(count);
    std::array<unsigned, OverlayPiece::most + 1>
        sides;  // of the first face, and times 8 the second
    for (std::size_t i = 0; i < count; ++i)
        sides[i] = sides_with(pair, 0, piece.corners[i]) | sides_with(pair, 1, piece.corners[i])
                                                               << 3;
    sides[count] = sides[0];
    for (std::size_t i = 0; i < count; ++i) {
        const unsigned both = sides[i] & sides[i + 1];
        if (both == 0) return false;
        piece.corners[i].goes_on(side_in(both & 7u), side_in(both >> 3));
    }
    return true;
}

// As `along` of terrain/cutting.py.
double height_along(const SurfaceCorner& tail, const SurfaceCorner& head, Point place) {
    const double share = std::min(std::max(share_between(tail.at, head.at, place), 0.0), 1.0);
    const double rise = head.height - tail.height;
    const double height = std::isfinite(rise) ? tail.height + share * rise
                                              : tail.height * (1 - share) + head.height * share;
    const auto [low, high] = std::minmax(tail.height, head.height);
    return std::min(std::max(height, low), high);
}

double height_over(const FacePair& pair, std::size_t face, std::size_t k) {
    const Face& over = pair.face(1 - face);
    const Point place = pair.face(face).at(k);
    const unsigned sides = sides_at(pair, 1 - face, k);
    if (sides == 0)
        return SurfaceFacet(over.corners[0], over.corners[1], over.corners[2]).height(place);
    for (std::size_t i = 0; i < 3; ++i)
        if (sides == sides_of_corner(i)) return over.corners[i].height;
    const std::size_t side = side_in(sides);
    SurfaceCorner tail = over.corners[tail_of(side)], head = over.corners[head_of(side)];
    if (before_xy(head.at, tail.at)) std::swap(tail, head);
    return height_along(tail, head, place);
}

namespace {

class Collector {
 public:
    Collector(const std::array<LocalSurface, 2>& surfaces, Nearness nearness, Pieces& found,
              Interrupt& interrupt)
        : surfaces_(surfaces), nearness_(nearness), found_(found), interrupt_(interrupt) {
        // About as many as of points at random; what is not used takes no memory.
        found_.pieces.reserve(3 * (surfaces[0].count() + surfaces[1].count()));
        for (std::size_t k : {0, 1}) found_.heights[k].assign(surfaces[k].vertices(), no_height);
    }

    Face face(std::size_t mesh, std::int32_t number) const { return surfaces_[mesh].face(number); }
    std::int32_t neighbor(std::size_t mesh, std::int32_t number, const Face&,
                          std::size_t side) const {
        return surfaces_[mesh].neighbor(number, side);
    }
    Nearness nearness() const { return nearness_; }
    bool is_whole() const { return true; }
    bool goes_on(Point, Point) const { return true; }

    void visit(std::int32_t number, std::int32_t other, const FacePair& pair) {
        if (number != last_) interrupt_.advance(3);
        last_ = number;
        if (!surfaces_[0].is_shown(number) || !surfaces_[1].is_shown(other)) return;
        if (!pair.overlap()) return;
        OverlayPiece piece{number, other, 0, {}, 0};
        if (!outline_of(pair, piece)) {
            found_.is_sound = false;
            return;
        }
        for (std::size_t i = 0; i < piece.count; ++i)
            if (!piece.corners[i].is_crossing()) add_height(pair, piece, piece.corners[i]);
        found_.pieces.push_back(piece);
    }

 private:
    void add_height(const FacePair& pair, const OverlayPiece& piece, PieceCorner corner) {
        const std::size_t of = corner.face();
        const std::int32_t face = of == 0 ? piece.face : piece.other;
        double& height =
            found_.heights[of][static_cast<std::size_t>(surfaces_[of].vertex(face, corner.k()))];
        if (!std::isnan(height)) return;
        height = height_over(pair, of, corner.k());
        const unsigned sides = nearness_.units > 0 ? sides_at(pair, 1 - of, corner.k()) : 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (sides == 1u << k) add_displacement(pair, of, corner.k(), k);
            if (sides != sides_of_corner(k) || of == 1) continue;
            const Point there = pair.face(1).at(k);
            if (before_xy(there, pair.face(0).at(corner.k())))
                found_.moved.emplace_back(surfaces_[0].vertex(face, corner.k()), there);
        }
    }

    void add_displacement(const FacePair& pair, std::size_t of, std::size_t k, std::size_t side) {
        const Face& over = pair.face(1 - of);
        const Point tail = over.at(tail_of(side)), head = over.at(head_of(side)),
                    at = pair.face(of).at(k);
        const double places[] = {tail.x, tail.y, head.x, head.y, at.x, at.y};
        double distance;
        find_distances(places, 1, &distance);
        found_.displacement = std::max(found_.displacement, distance);
    }

    const std::array<LocalSurface, 2>& surfaces_;
    Nearness nearness_;
    Pieces& found_;
    Interrupt& interrupt_;
    std::int32_t last_ = -1;
};

}  // namespace

bool find_pieces(const std::array<LocalSurface, 2>& surfaces, std::int32_t face, std::int32_t other,
                 Nearness nearness, Pieces& found, Interrupt& interrupt) {
    Patience patience(interrupt);
    Collector collector(surfaces, nearness, found, interrupt);
    Flood<Collector> flood(collector, surfaces[0].count(), surfaces[1].count(), patience);
    flood.run(face, other);
    if (patience.ends(0)) return false;
    found.starts.assign(surfaces[0].count(), Pieces::none);
    OverlayPiece* const all = found.pieces.data();
    for (std::size_t first = 0, last = 0; first < found.pieces.size(); first = last) {
        if (patience.ends()) return false;
        const std::int32_t number = all[first].face;
        while (last < found.pieces.size() && all[last].face == number) ++last;
        found.starts[static_cast<std::size_t>(number)] = static_cast<std::uint32_t>(first);
        std::sort(all + first, all + last,
                  [](const OverlayPiece& a, const OverlayPiece& b) { return a.other < b.other; });
        for (std::size_t i = first; i < last; ++i) {
            all[i].first = static_cast<std::uint32_t>(found.corners);
            found.corners += all[i].count;
        }
    }
    return true;
}

}  // namespace liftmesh
