// What faces of two surfaces have in common: convex pieces with at most six corners.
//
// The flood (flood.hpp) finds the pairs of faces, and their outlines are those of a second surface
// that was moved by an infinitesimal (face_pair.hpp). As that move goes to zero, corners of the
// outline come together where turns are zero: at vertices of both surfaces, or of one on a side of
// the other. What is left are the corners of the common part itself, each one an extreme point of
// it: no vertex of either surface, and no crossing, is inside of a side of a piece.
#pragma once

#include "parallel/thread_pool.hpp"
#include "surface/local_surface.hpp"

namespace liftmesh {

// A corner: one of the first face, of the second, or where two sides cross. With it, the sides on
// which the outline goes on from there, one of either face or of both.
class PieceCorner {
 public:
    static PieceCorner at(std::size_t face, std::size_t k) { return PieceCorner(3 * face + k); }
    static PieceCorner crossing(std::size_t side, std::size_t other) {
        return PieceCorner(6 + 3 * side + other);
    }

    bool is_crossing() const { return place() >= 6; }
    std::size_t face() const { return place() / 3; }  // where it is no crossing
    std::size_t k() const { return place() % 3; }
    // Where it is one.
    std::size_t side(std::size_t face) const {
        return face == 0 ? (place() - 6u) / 3 : (place() - 6u) % 3;
    }
    bool same_place(PieceCorner other) const { return place() == other.place(); }

    static constexpr std::size_t no_side = 3;
    void goes_on(std::size_t side, std::size_t other) {
        bits_ = static_cast<std::uint8_t>(place() | side << 4 | other << 6);
    }
    std::size_t next_side(std::size_t face) const { return bits_ >> (face == 0 ? 4 : 6) & 3u; }

    PieceCorner() = default;

 private:
    explicit PieceCorner(std::size_t place) : bits_(static_cast<std::uint8_t>(place)) {}
    unsigned place() const { return bits_ & 15u; }

    std::uint8_t bits_ = 0;
};

struct OverlayPiece {
    static constexpr std::size_t most = 6;

    std::int32_t face, other;
    std::uint32_t first;                    // how many corners there are before
    std::array<PieceCorner, most> corners;  // counter-clockwise
    std::uint8_t count;

    std::int32_t face_of(std::size_t surface) const { return surface == 0 ? face : other; }
};

// Of faces that overlap. False if their turns contradict each other, as of faces without area.
bool outline_of(const FacePair& pair, OverlayPiece& piece);

// A corner of a face in the other one: where it counts as being, how high that one is there, and
// how far it is from the side that it counts as being on.
struct CornerOver {
    Point at;
    double height, displacement;
};
CornerOver corner_over(const FacePair& pair, std::size_t face, std::size_t k);

// On a side from its lexicographically lesser end, as near to it as a rounded place is.
double height_along(const SurfaceCorner& tail, const SurfaceCorner& head, Point place);

// All pieces of faces that are shown: those of a first face together, by the second, and first
// faces in an order that depends on the surfaces and where the flood began.
struct Pieces {
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    Buffer<OverlayPiece> pieces;
    std::size_t count = 0, corners = 0;  // of all
    std::vector<std::uint32_t> starts;   // of each first face; `none` if it has none
    bool is_sound = true;

    const OverlayPiece* find(std::int32_t face, std::int32_t other) const {
        const std::size_t start = starts[static_cast<std::size_t>(face)];
        for (std::size_t i = start; i < count && pieces[i].face == face; ++i)
            if (pieces[i].other == other) return &pieces[i];
        return nullptr;
    }

    // Whether pieces of one face of a surface come before those of another one.
    bool is_before(std::size_t surface, std::int32_t one, std::int32_t two) const {
        if (surface == 1) return one < two;
        return starts[static_cast<std::size_t>(one)] < starts[static_cast<std::size_t>(two)];
    }
};

// From two faces that touch; nearness as for pairs. Advances by three for each first face. False if
// the interrupt came first.
bool find_pieces(const std::array<LocalSurface, 2>& surfaces, std::int32_t face, std::int32_t other,
                 Nearness nearness, Pieces& found, ThreadPool& pool);

}  // namespace liftmesh
