// Two faces laid over each other: which sides touch the other face, and the outline of what they
// have in common.
//
// Everything follows from the turns of the corners of each face about the sides of the other, whose
// signs are exact. Where one is zero, the second face counts as moved by (e, e^2), an infinitesimal
// e: then no corner is on a side, sides cross or do not, and the outline runs along one face to
// where it leaves the other, and from there along that one. What the move made has no area.
//
// Nothing here depends on which face comes first, the move apart, nor on a power of two by which
// coordinates are multiplied, nor on where the origin is, as long as moving it rounds nothing.
#pragma once

#include "surface/relief.hpp"

namespace liftmesh {

// Counter-clockwise, from the lexicographically least corner on. Side k is opposite corner k.
struct Face {
    std::array<SurfaceCorner, 3> corners;
    std::size_t first;  // the corner of the mesh with which it begins
    double extent;      // the longer side of its box

    Point at(std::size_t k) const { return corners[k].at; }
    std::size_t of_mesh(std::size_t k) const { return k + first < 3 ? k + first : k + first - 3; }
};

constexpr std::size_t after(std::size_t k) {
    return k == 2 ? 0 : k + 1;
}
constexpr std::size_t tail_of(std::size_t side) {
    return after(side);
}
constexpr std::size_t head_of(std::size_t side) {
    return after(after(side));
}

// Of three points. The sign is exact; the value has an error of at most 2^-51 of the size.
struct Turn {
    double value, size;
};

// A turn counts as zero where moving coordinates by so many units in their last place, if any, can
// make it zero. Of faces no coordinate of which is larger; and none counts as less than the least.
struct Nearness {
    double units = 0, largest = 0, least = 0;
};

// Of three points, of which the last one is relative to a side: whether their turn is that small.
// It is the same with both ends exchanged.
bool is_near(double turn, Point tail, Point head, Point at, Nearness nearness);

// Whether one of the corners is as near to the side opposite.
bool is_flat(const Face& face, Nearness nearness);

class FacePair {
 public:
    // A corner of a face in the other, or a side of each where they cross.
    struct Corner {
        bool is_crossing;
        std::size_t face, k;  // a corner of a face; or 0, and a side of the first
        std::size_t other;    // a side of the second
    };
    struct Outline {
        static constexpr std::size_t most = 12;  // six, unless rows were written meanwhile
        std::array<Corner, most> corners;
        std::size_t count = 0;

        void add(const Corner& corner) {
            if (count < most) corners[count++] = corner;
        }
    };

    FacePair(const Face& first, const Face& second, Nearness nearness = {});

    const Face& face(std::size_t number) const { return *faces_[number]; }
    Nearness nearness() const { return nearness_; }
    // Of a corner of the other face about a side of a face.
    const Turn& turn_about(std::size_t face, std::size_t side, std::size_t corner) const {
        return turns_[face][side][corner];
    }
    // Whether a side of a face touches the closed other one: no side of either has all of the other
    // beyond it.
    bool touches(std::size_t face, std::size_t side) const {
        const int ends = (1 << tail_of(side)) | (1 << head_of(side));
        for (const Sides& each : sides_[1 - face])
            if ((each.negative & ends) == ends) return false;
        return sides_[face][side].positive != all && sides_[face][side].negative != all;
    }
    // Whether they have more than a point in common: no side of either has all of the other beyond
    // it but for a point, and no more than that on it.
    bool meets(std::size_t face, std::size_t side) const {
        const int ends = (1 << tail_of(side)) | (1 << head_of(side));
        for (const Sides& each : sides_[1 - face])
            if ((each.positive & ends) == 0 && (each.negative & ends) != 0) return false;
        const Sides& corners = sides_[face][side];
        const int on = all & ~(corners.positive | corners.negative);
        return (corners.positive != 0 && corners.negative != 0) || (on & (on - 1)) != 0;
    }
    // Whether the faces have an area in common: convex sets without an inner point in common are
    // separated by a line along a side of one.
    bool overlap() const {
        for (const auto& sides : sides_)
            for (const Sides& each : sides)
                if (each.above == 0) return false;
        return true;
    }
    // Of that area, counter-clockwise.
    Outline outline() const;

 private:
    static constexpr int all = 7;

    // Of corners of the other face: a bit for each that is on either side of a side, and for those
    // on its left that are not near to it. The second face having been moved, all are to the left
    // or not.
    struct Sides {
        std::uint8_t positive = 0, negative = 0, above = 0, left = 0;
    };

    void set_turn(std::size_t face, std::size_t side, std::size_t corner, Point tail, Point head);
    void set_sides(std::size_t face, std::size_t side);
    Corner crossing(std::size_t face, std::size_t side, std::size_t other_side) const;
    std::size_t exit(std::size_t face, std::size_t side) const;
    void follow(std::size_t face, std::size_t side, std::size_t other, Outline& outline) const;

    std::array<const Face*, 2> faces_;
    Nearness nearness_;
    double reach_;  // no near turn has a larger value
    Turn turns_[2][3][3];
    Sides sides_[2][3];
};

Face face_of(const Relief& relief, std::int32_t simplex);

}  // namespace liftmesh
