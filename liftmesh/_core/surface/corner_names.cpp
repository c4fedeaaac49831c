#include "surface/corner_names.hpp"

namespace liftmesh {

namespace {

class Namer {
 public:
    Namer(const std::array<LocalSurface, 2>& surfaces, const Pieces& pieces, CornerNames& names,
          ThreadPool& pool, bool& is_sound)
        : surfaces_(surfaces),
          pieces_(pieces),
          names_(names),
          pool_(pool),
          is_sound_(is_sound),
          first_(surfaces[0].vertices()),
          vertices_(first_ + surfaces[1].vertices()) {}

    bool run() {
        if (pieces_.corners >= most_numbers) return is_sound_ = false;
        names_.of_corners = allocate<std::int32_t>(pieces_.corners);
        names_.owners.assign(vertices_, Pieces::none);
        names_.crossings.resize(blocks(pieces_.count, block_of_pieces));
        const bool done = in_pieces([this](const OverlayPiece& piece, std::size_t block) {
            return name_corners_of(piece, names_.crossings[block]);
        });
        if (!done) return false;
        names_.before = {vertices_};
        for (const std::vector<SideCrossing>& each : names_.crossings)
            names_.before.push_back(names_.before.back() + each.size());
        if (names_.before.back() >= most_numbers) return is_sound_ = false;
        const auto finish = [this](const OverlayPiece& piece, std::size_t block) {
            const auto before = static_cast<std::int32_t>(names_.before[block]);
            for (std::size_t i = 0; i < piece.count; ++i) {
                std::int32_t& name = names_.of_corners[piece.first + i];
                if (piece.corners[i].is_crossing() && name >= 0) name += before;
            }
            return true;
        };
        const auto look_up = [this](const OverlayPiece& piece, std::size_t) {
            for (std::size_t i = 0; i < piece.count; ++i) {
                std::int32_t& name = names_.of_corners[piece.first + i];
                if (name < 0 && (name = names_.of_corners[static_cast<std::size_t>(~name)]) < 0)
                    return false;
            }
            return true;
        };
        return in_pieces(finish) && in_pieces(look_up);
    }

 private:
    template <class Work>
    bool in_pieces(Work work) {
        return hold_in_pieces(pieces_, pool_, is_sound_, work);
    }

    // Crossings are numbers in their block, or where else they have a number: its complement.
    bool name_corners_of(const OverlayPiece& piece, std::vector<SideCrossing>& crossings) {
        for (std::size_t i = 0; i < piece.count; ++i) {
            const PieceCorner corner = piece.corners[i];
            if (corner.is_crossing()) {
                if (!name_crossing(piece, i, crossings)) return false;
                continue;
            }
            const std::int32_t vertex =
                surfaces_[corner.face()].vertex(piece.face_of(corner.face()), corner.k());
            const std::size_t name = static_cast<std::size_t>(vertex) + corner.face() * first_;
            names_.of_corners[piece.first + i] = static_cast<std::int32_t>(name);
            own_vertex(name, piece);
        }
        return true;
    }

    // Of the pieces that have a vertex, that of the least faces is its owner.
    void own_vertex(std::size_t name, const OverlayPiece& piece) {
        const auto number = static_cast<std::uint32_t>(&piece - pieces_.pieces.get());
        const platform::Shared owner(names_.owners[name]);
        std::uint32_t held = owner.load();
        while ((held == Pieces::none || is_less(piece, pieces_.pieces[held])) &&
               !owner.exchange(held, number)) {
        }
    }
    static bool is_less(const OverlayPiece& a, const OverlayPiece& b) {
        return a.face != b.face ? a.face < b.face : a.other < b.other;
    }

    bool name_crossing(const OverlayPiece& piece, std::size_t i,
                       std::vector<SideCrossing>& crossings) {
        const PieceCorner corner = piece.corners[i];
        const std::array<std::size_t, 2> sides{corner.side(0), corner.side(1)};
        const std::array<std::int32_t, 2> from{piece.face, piece.other};
        std::array<std::int32_t, 2> owner = from;
        for (std::size_t f : {0, 1}) {
            const std::int32_t beyond = surfaces_[f].shown_neighbor(from[f], sides[f]);
            if (beyond >= 0 && pieces_.is_before(f, beyond, from[f])) owner[f] = beyond;
        }
        std::int32_t& name = names_.of_corners[piece.first + i];
        if (owner == from) {
            name = static_cast<std::int32_t>(crossings.size());
            const auto [p, q] = ends_of(piece, 0, sides[0]);
            const auto [r, t] = ends_of(piece, 1, sides[1]);
            crossings.push_back({p, q, r, t});
            return true;
        }
        const OverlayPiece* const known = pieces_.find(owner[0], owner[1]);
        if (!known) return false;
        const std::size_t place = crossing_in(*known, from, sides);
        name = ~static_cast<std::int32_t>(known->first + place);
        return place < known->count;
    }

    // Which corner of a piece is the crossing of the same sides as in another one; `count` if none.
    std::size_t crossing_in(const OverlayPiece& piece, const std::array<std::int32_t, 2>& from,
                            const std::array<std::size_t, 2>& sides) const {
        std::array<std::size_t, 2> own = sides;
        for (std::size_t f : {0, 1}) {
            const std::int32_t face = piece.face_of(f);
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

    // The lesser and the greater end of a side.
    std::pair<std::int32_t, std::int32_t> ends_of(const OverlayPiece& piece, std::size_t surface,
                                                  std::size_t side) const {
        const LocalSurface& of = surfaces_[surface];
        const std::int32_t face = piece.face_of(surface), tail = of.vertex(face, tail_of(side)),
                           head = of.vertex(face, head_of(side));
        if (before_xy(of.corner(head).at, of.corner(tail).at)) return {head, tail};
        return {tail, head};
    }

    const std::array<LocalSurface, 2>& surfaces_;
    const Pieces& pieces_;
    CornerNames& names_;
    ThreadPool& pool_;
    bool& is_sound_;
    std::size_t first_, vertices_;  // how many of the first surface, and of both
};

}  // namespace

bool name_corners(const std::array<LocalSurface, 2>& surfaces, const Pieces& pieces,
                  CornerNames& names, ThreadPool& pool, bool& is_sound) {
    return Namer(surfaces, pieces, names, pool, is_sound).run();
}

}  // namespace liftmesh
