#include "surface/pieces.hpp"

#include "parallel/blocks.hpp"
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
    constexpr double ulp = 0x1p-52, more = 8;
    const auto is_near = [nearness](double a, double b) {
        return std::fabs(a - b) <=
               more * nearness.units * ulp * std::max({std::fabs(a), std::fabs(b), nearness.least});
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

CornerOver corner_over(const FacePair& pair, std::size_t face, std::size_t k) {
    const Face& over = pair.face(1 - face);
    const Point place = pair.face(face).at(k);
    const unsigned sides = sides_at(pair, 1 - face, k);
    if (sides == 0)
        return {place,
                SurfaceFacet(over.corners[0], over.corners[1], over.corners[2]).height(place), 0};
    for (std::size_t i = 0; i < 3; ++i) {
        if (sides != sides_of_corner(i)) continue;
        const auto [there, height] = over.corners[i];
        return {face == 0 && before_xy(there, place) ? there : place, height, 0};
    }
    const std::size_t side = side_in(sides);
    SurfaceCorner tail = over.corners[tail_of(side)], head = over.corners[head_of(side)];
    const double places[] = {tail.at.x, tail.at.y, head.at.x, head.at.y, place.x, place.y};
    double distance = 0;
    if (sides == 1u << side && pair.nearness().units > 0) find_distances(places, 1, &distance);
    if (before_xy(head.at, tail.at)) std::swap(tail, head);
    return {place, height_along(tail, head, place), distance};
}

namespace {

// First faces that follow each other along the curve, their pieces, and pairs from which to visit
// them, or others.
struct Stretch {
    static constexpr std::size_t length = std::size_t{1} << 10;

    std::vector<FloodStart> starts, beyond;
    std::vector<OverlayPiece> pieces;
    std::size_t corners = 0;
    bool is_sound = true;
};

// Finds the pieces of one stretch after the other.
class Collector {
 public:
    Collector(const std::array<LocalSurface, 2>& surfaces, Nearness nearness,
              std::vector<std::int32_t>& start, Interrupt& interrupt)
        : surfaces_(surfaces),
          nearness_(nearness),
          interrupt_(interrupt),
          patience_(interrupt),
          flood_(*this, start, surfaces[1].count(), patience_) {}

    std::optional<FloodStart> overlap(std::int32_t face, std::int32_t other) {
        return flood_.overlap(face, other);
    }

    void run(Stretch& stretch, std::size_t number) {
        stretch_ = &stretch;
        const std::size_t first = number * Stretch::length,
                          last = std::min(first + Stretch::length, surfaces_[0].count());
        flood_.run(std::exchange(stretch.starts, {}), first, last, stretch.beyond);
    }

    // For the flood.

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
        stretch_->is_sound = outline_of(pair, piece) && stretch_->is_sound;
        stretch_->corners += piece.count;
        stretch_->pieces.push_back(piece);
    }

 private:
    const std::array<LocalSurface, 2>& surfaces_;
    Nearness nearness_;
    Interrupt& interrupt_;
    Patience patience_;
    Flood<Collector> flood_;
    Stretch* stretch_ = nullptr;
    std::int32_t last_ = -1;
};

// Stretches hand over to each other in rounds. Those of a round are visited at the same time, by
// any threads: what they find depends on what they were handed alone.
class Rounds {
 public:
    Rounds(const std::array<LocalSurface, 2>& surfaces, Nearness nearness, ThreadPool& pool)
        : surfaces_(surfaces),
          nearness_(nearness),
          pool_(pool),
          start_(surfaces[0].count(), Flood<Collector>::unvisited),
          stretches_(blocks(surfaces[0].count(), Stretch::length)),
          collectors_(std::min(pool.size(), most_collectors)) {}

    // False if the interrupt came first.
    bool run(std::int32_t face, std::int32_t other) {
        const auto overlap = collector(0).overlap(face, other);
        std::vector<std::size_t> ready;
        if (overlap) hand_over({*overlap}, ready);
        while (!ready.empty()) {
            std::atomic<std::size_t> next = 0;
            const auto visit = [&](std::size_t task) {
                Collector& own = collector(task);
                for (std::size_t i; (i = next++) < ready.size();)
                    own.run(stretches_[ready[i]], ready[i]);
            };
            if (!pool_.run(std::min(ready.size(), collectors_.size()), visit)) return false;
            std::vector<std::size_t> following;
            for (const std::size_t i : ready)
                hand_over(std::exchange(stretches_[i].beyond, {}), following);
            ready.swap(following);
        }
        return !pool_.interrupt().requested();
    }

    // All pieces, in the order of the stretches. False as above.
    bool unite(Pieces& found) {
        std::vector<std::size_t> pieces, corners;
        for (const Stretch& each : stretches_) {
            pieces.push_back(found.count);
            corners.push_back(found.corners);
            found.count += each.pieces.size();
            found.corners += each.corners;
            found.is_sound = found.is_sound && each.is_sound;
        }
        found.pieces = allocate<OverlayPiece>(found.count);
        found.starts.assign(surfaces_[0].count(), Pieces::none);
        return pool_.run(stretches_.size(), [&](std::size_t i) {
            const std::vector<OverlayPiece> own = std::exchange(stretches_[i].pieces, {});
            std::copy(own.begin(), own.end(), found.pieces.get() + pieces[i]);
            number(found, pieces[i], pieces[i] + own.size(), corners[i]);
        });
    }

 private:
    static constexpr unsigned most_collectors = 16;  // each has a number for every second face

    Collector& collector(std::size_t i) {
        if (!collectors_[i])
            collectors_[i] =
                std::make_unique<Collector>(surfaces_, nearness_, start_, pool_.interrupt());
        return *collectors_[i];
    }

    // To the stretches that have them, which become ready.
    void hand_over(const std::vector<FloodStart>& starts, std::vector<std::size_t>& ready) {
        for (const FloodStart& each : starts) {
            const auto face = static_cast<std::size_t>(each.face);
            if (start_[face] != Flood<Collector>::unvisited) continue;
            Stretch& to = stretches_[face / Stretch::length];
            if (to.starts.empty()) ready.push_back(face / Stretch::length);
            to.starts.push_back(each);
        }
    }

    // Sorts the pieces of each first face, from one on that is the first of it.
    static void number(Pieces& found, std::size_t first, std::size_t last, std::size_t corners) {
        OverlayPiece* const all = found.pieces.get();
        while (first < last) {
            const std::size_t begin = first;
            while (first < last && all[first].face == all[begin].face) ++first;
            found.starts[static_cast<std::size_t>(all[begin].face)] =
                static_cast<std::uint32_t>(begin);
            std::sort(all + begin, all + first, [](const OverlayPiece& a, const OverlayPiece& b) {
                return a.other < b.other;
            });
            for (std::size_t i = begin; i < first; ++i) {
                all[i].first = static_cast<std::uint32_t>(corners);
                corners += all[i].count;
            }
        }
    }

    const std::array<LocalSurface, 2>& surfaces_;
    Nearness nearness_;
    ThreadPool& pool_;
    std::vector<std::int32_t> start_;
    std::vector<Stretch> stretches_;
    std::vector<std::unique_ptr<Collector>> collectors_;
};

}  // namespace

bool find_pieces(const std::array<LocalSurface, 2>& surfaces, std::int32_t face, std::int32_t other,
                 Nearness nearness, Pieces& found, ThreadPool& pool) {
    Rounds rounds(surfaces, nearness, pool);
    return rounds.run(face, other) && rounds.unite(found);
}

}  // namespace liftmesh
