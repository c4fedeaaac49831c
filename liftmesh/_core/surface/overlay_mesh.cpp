#include "surface/overlay_mesh.hpp"

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "predicates/crossings.hpp"
#include "predicates/scale.hpp"
#include "sorting/patient_sort.hpp"
#include "surface/corner_names.hpp"

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
    Overlaid(const std::array<LocalSurface, 2>& surfaces, const Pieces& pieces, Nearness nearness,
             OverlayMesh& found, ThreadPool& pool)
        : surfaces_(surfaces),
          pieces_(pieces),
          nearness_(nearness),
          found_(found),
          pool_(pool),
          first_(surfaces[0].vertices()),
          vertices_(first_ + surfaces[1].vertices()) {}

    // False if the interrupt came first, or the result is not sound.
    bool run() {
        return advanced(name(), 2) && advanced(place_rows(), 3) && advanced(triangulate(), 1) &&
               link() && name_rows();
    }

 private:
    bool advanced(bool is_done, std::size_t tenths) {
        pool_.interrupt().advance(tenths * surfaces_[0].count());
        return is_done;
    }

    bool name() {
        if (!name_corners(surfaces_, pieces_, names_, pool_, found_.is_sound)) return false;
        found_.crossings = names_.count() - vertices_;
        return true;
    }

    bool unsound() {
        found_.is_sound = false;
        return false;
    }

    template <class Work>
    bool in_all(std::size_t count, std::size_t length, Work work) {
        return hold_in_blocks(count, length, pool_, found_.is_sound, work);
    }
    template <class Work>
    bool in_pieces(Work work) {
        return hold_in_pieces(pieces_, pool_, found_.is_sound, work);
    }

    bool place_rows() {
        const std::size_t names = names_.count();
        places_ = allocate<Point>(names);
        rises_ = allocate<double>(names);
        std::vector<std::uint32_t> used;
        const auto is_used = [this](std::size_t name) {
            return names_.owners[name] != Pieces::none;
        };
        if (!select(vertices_, pool_, is_used, used)) return false;
        found_.rows = used.size() + found_.crossings;
        const Buffer<Site> sites = allocate<Site>(found_.rows);
        const auto set = [&](std::size_t i, std::size_t name) {
            sites[i] = {places_[name], static_cast<Row>(name)};
            return is_finite(places_[name]);
        };
        const auto place_used = [&](std::size_t i, std::size_t) {
            place_vertex(used[i]);
            return set(i, used[i]);
        };
        const auto place_block = [&](std::size_t block, std::size_t) {
            std::size_t name = names_.before[block], i = used.size() + name - vertices_;
            bool is_sound = true;
            for (const SideCrossing& each : names_.crossings[block]) {
                places_[name] = place_of(each);
                rises_[name] = rise_at(each, places_[name]);
                is_sound = set(i++, name++) && is_sound;
            }
            return is_sound;
        };
        const auto is_less = [](const Site& a, const Site& b) {
            return before_xy(a.point, b.point);
        };
        if (!in_all(used.size(), block_of_pieces, place_used) ||
            !in_all(names_.crossings.size(), 1, place_block))
            return false;
        found_.displacement = displacement_;
        names_.crossings.clear();
        return patient_sort(std::span(sites.get(), found_.rows), is_less, pool_) &&
               number_rows(sites.get());
    }

    bool number_rows(const Site* sites) {
        found_.points = allocate<Point>(found_.rows);
        found_.rises = allocate<double>(found_.rows);
        rows_ = allocate<std::int32_t>(names_.count());
        std::vector<Range> ranges(blocks(found_.rows, block_of_pieces));
        const auto number = [&](std::size_t row, Range& range) {
            const auto [place, name] = sites[row];
            if (row > 0 && place == sites[row - 1].point) return false;
            range.add(place);
            found_.points[row] = place;
            found_.rises[row] = rises_[name];
            rows_[name] = static_cast<std::int32_t>(row);
            return true;
        };
        const auto number_block = [&](std::size_t block, std::size_t) {
            std::size_t row = block * block_of_pieces;
            const std::size_t last = std::min(row + block_of_pieces, found_.rows);
            Range range;
            while (row < last && number(row, range)) ++row;
            ranges[block] = range;
            return row == last;
        };
        if (!in_all(ranges.size(), 1, number_block)) return false;
        Range all;
        for (const Range& each : ranges) all.add(each);
        const Scale scale(all);
        guard_ = scale.moves ? Guard::anywhere() : scale.guard;
        return true;
    }

    // Where a vertex is over the other surface, as its owner has it.
    void place_vertex(std::size_t name) {
        const OverlayPiece& piece = pieces_.pieces[names_.owners[name]];
        const std::size_t of = name < first_ ? 0 : 1;
        const auto vertex = static_cast<std::int32_t>(name - of * first_);
        const Face own = surfaces_[0].face(piece.face), other = surfaces_[1].face(piece.other);
        const FacePair pair(own, other, nearness_);
        std::size_t k = 0;
        while (k < 2 && surfaces_[of].vertex(piece.face_of(of), k) != vertex) ++k;
        const CornerOver over = corner_over(pair, of, k);
        const double height = pair.face(of).corners[k].height;
        places_[name] = over.at;
        rises_[name] = of == 0 ? height - over.height : over.height - height;
        add_displacement(over.displacement);
    }

    const SurfaceCorner& end_of(const SideCrossing& crossing, std::size_t i) const {
        return surfaces_[i / 2].corner(crossing[i]);
    }

    double rise_at(const SideCrossing& crossing, Point place) const {
        const auto height = [&](std::size_t i) {
            return height_along(end_of(crossing, i), end_of(crossing, i + 1), place);
        };
        return height(0) - height(2);
    }

    // From the lesser of both sides, so that it is the same where the surfaces are exchanged.
    Point place_of(const SideCrossing& crossing) {
        std::array<Point, 4> ends;
        for (std::size_t i = 0; i < 4; ++i) ends[i] = end_of(crossing, i).at;
        const std::size_t later = ends[0] == ends[2] ? 1 : 0;
        if (before_xy(ends[2 + later], ends[later])) {
            std::swap(ends[0], ends[2]);
            std::swap(ends[1], ends[3]);
        }
        const auto [place, residual] = crossing_of(&ends[0].x);
        constexpr double diagonal = 1.5;  // at least the root of 2
        if (diagonal * std::max(std::fabs(residual.x), std::fabs(residual.y)) > displacement_)
            for (const std::size_t i : {0, 2})
                add_displacement(displacement_across(residual, ends[i], ends[i + 1]));
        return place;
    }

    static double displacement_across(Point residual, Point tail, Point head) {
        const double x = head.x - tail.x, y = head.y - tail.y, length = std::hypot(x, y);
        return std::fabs(residual.x * (y / length) - residual.y * (x / length));
    }

    void add_displacement(double distance) {
        double held = displacement_;
        while (distance > held && !displacement_.compare_exchange_weak(held, distance)) {
        }
    }

    // The triangles of each piece, and which of them has each of its sides.
    bool triangulate() {
        const std::size_t count = pieces_.corners - 2 * pieces_.count;
        if (count >= most_numbers / 3) return unsound();
        found_.triangles = count;
        found_.simplices = allocate<std::int32_t>(3 * count);
        found_.neighbors = allocate<std::int32_t>(3 * count);
        found_.bits = allocate<std::uint8_t>(count);
        sides_ = allocate<OverlaySide>(pieces_.corners);
        return in_pieces([this](const OverlayPiece& piece, std::size_t) {
            const std::size_t n = piece.count;
            const std::int32_t* const rows = names_.of_corners.get() + piece.first;
            for (std::size_t i = 0; i < n; ++i)
                if (orient2d(at(rows[i]), at(rows[(i + 1) % n]), at(rows[(i + 2) % n])) <= 0)
                    return false;
            const auto before = static_cast<std::size_t>(&piece - pieces_.pieces.get());
            const std::size_t first = piece.first - 2 * before;
            std::fill_n(found_.neighbors.get() + 3 * first, 3 * (n - 2), unlinked);
            std::fill_n(found_.bits.get() + first, n - 2, std::uint8_t{0});
            std::size_t next = first;
            sides_[piece.first + n - 1] = divide(piece, 0, n - 1, next);
            return true;
        });
    }

    // What is between two corners of a piece, seen from the chord: the Delaunay triangle at that,
    // and what is beyond it. Returns where the chord is.
    OverlaySide divide(const OverlayPiece& piece, std::size_t i, std::size_t j, std::size_t& next) {
        const std::int32_t* const rows = names_.of_corners.get() + piece.first;
        std::size_t apex = i + 1;
        for (std::size_t m = i + 2; m < j; ++m)
            if (is_inside(rows[i], rows[apex], rows[j], rows[m])) apex = m;
        const std::size_t t = next++;
        std::int32_t* const corners = found_.simplices.get() + 3 * t;
        corners[0] = rows[i];
        corners[1] = rows[apex];
        corners[2] = rows[j];
        const auto sides = static_cast<OverlaySide>(3 * t);
        join_within(piece, sides + 2, i, apex, next);
        join_within(piece, sides, apex, j, next);
        return sides + 1;
    }

    void join_within(const OverlayPiece& piece, OverlaySide side, std::size_t i, std::size_t j,
                     std::size_t& next) {
        if (i + 1 == j)
            sides_[piece.first + i] = side;
        else
            join(side, divide(piece, i, j, next));
    }

    void join(OverlaySide one, OverlaySide other) {
        found_.neighbors[one] = static_cast<std::int32_t>(other / 3);
        found_.neighbors[other] = static_cast<std::int32_t>(one / 3);
    }

    bool link() {
        return in_pieces([this](const OverlayPiece& piece, std::size_t) {
            for (std::size_t i = 0; i < piece.count; ++i)
                if (!link_side(piece, i)) return false;
            return true;
        });
    }

    // False where a side has not been linked.
    bool name_rows() {
        return in_all(
            3 * found_.triangles, 3 * block_of_pieces, [this](std::size_t i, std::size_t) {
                found_.simplices[i] = rows_[static_cast<std::size_t>(found_.simplices[i])];
                return found_.neighbors[i] != unlinked;
            });
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
        if (pieces_.is_before(is_same, beyond[is_same], piece.face_of(is_same))) return true;
        const OverlayPiece* const next = pieces_.find(beyond[0], beyond[1]);
        if (!next) return false;
        const std::size_t n = piece.count, m = next->count;
        const std::int32_t tail = names_.of_corners[piece.first + i],
                           head = names_.of_corners[piece.first + (i + 1) % n];
        const std::int32_t* const rows = names_.of_corners.get() + next->first;
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
        platform::Shared(found_.bits[side / 3]).fetch_or(static_cast<std::uint8_t>(1u << side % 3));
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

    static constexpr std::int32_t unlinked = -2;

    const std::array<LocalSurface, 2>& surfaces_;
    const Pieces& pieces_;
    Nearness nearness_;
    OverlayMesh& found_;
    ThreadPool& pool_;
    std::size_t first_, vertices_;  // how many of the first surface, and of both
    CornerNames names_;
    Buffer<Point> places_;  // of each name
    Buffer<double> rises_;
    std::atomic<double> displacement_ = 0;
    Buffer<std::int32_t> rows_;
    Buffer<OverlaySide> sides_;  // from each corner on
    Guard guard_ = Guard::in_window();
};

}  // namespace

bool overlay_mesh(const Relief& first, const Relief& second, std::int32_t face, std::int32_t other,
                  OverlayMesh& found, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    const std::array<const Relief*, 2> given{&first, &second};
    ThreadPool pool(threads.for_rows(first.mesh().count + second.mesh().count), interrupt);
    std::array<LocalSurface, 2> surfaces;
    if (!pool.run(2, [&](std::size_t k) { surfaces[k].read(*given[k], pool.interrupt()); }))
        return false;
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
        if (!find_pieces(surfaces, faces[0], faces[1], nearness, pieces, pool)) return false;
        found.is_sound = pieces.is_sound;
        if (!found.is_sound) continue;
        if (Overlaid(surfaces, pieces, nearness, found, pool).run()) break;
        if (found.is_sound) return false;
    }
    if (is_turned && found.is_sound)
        for (std::size_t row = 0; row < found.rows; ++row) found.rises[row] = 0 - found.rises[row];
    return true;
}

}  // namespace liftmesh
