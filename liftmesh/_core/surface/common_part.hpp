// The volumes between two faces over what they have in common.
//
// A corner of the outline that is one of a face has the weights of three turns in the other; where
// two sides cross, it divides each by two turns. In thin faces a rounded turn may be wrong in every
// digit: those that are used are computed again with more, so that corners and heights are right
// relative to the sides, whatever the shape of the faces. Then the part is cut into triangles, from
// its least corner on, and their prisms are measured where the second face is above, and below.
//
// Coordinates are relative to a corner of the smaller face. What is rounded in them is known
// beforehand relative to that face; where that is not enough, because little is in common or the
// faces are close together, double words replace the doubles.
#pragma once

#include "base/double_word.hpp"
#include "surface/face_pair.hpp"

namespace liftmesh {

using Long = DoubleWord<double>;

inline double as_double(double a) {
    return a;
}
inline double as_double(const Long& a) {
    return a.high;
}

// The value of a turn, within some units in the last place. Its sign is exact.
Long precise(const Turn& turn, Point a, Point b, Point c);

struct Volumes {
    double above = 0, below = 0, area = 0;
    double steepness = 0;  // the largest difference that heights come from, where they are rounded
    double rise = 0;       // the largest distance
    double rounding = 0;   // the square of lengths relative to which coordinates are rounded
};

using Triangle = std::array<Point, 3>;

// With `Real` for a double or a double word; `part`, if not null, is a triangle that cuts it.
template <class Real>
class CommonPart {
 public:
    explicit CommonPart(const FacePair& pair) : pair_(pair), origin_(origin_of(pair)) {}

    Volumes measure(const Triangle* part);

 private:
    // Relative to the origin, and how far the second face is above the first.
    struct Corner {
        Real x, y, rise;
    };
    struct Polygon {
        static constexpr std::size_t most = 24;
        std::array<Corner, most> corners;
        std::size_t count = 0;

        void add(const Corner& corner) {
            if (count < most) corners[count++] = corner;
        }
    };

    Point origin_of(const FacePair& pair);
    Real turned(std::size_t face, std::size_t side, std::size_t corner) const;
    Corner at_corner(std::size_t face, std::size_t k);
    Corner at_crossing(std::size_t side, std::size_t other);
    Polygon polygon();
    Polygon clipped(const Polygon& polygon, Point tail, Point head);
    static void begin_at_least(Polygon& polygon);
    static Real cross(const Corner& o, const Corner& p, const Corner& q);
    static void add_prism(Real area, std::array<Real, 3> rise, Real& above, Real& below);

    const FacePair& pair_;
    double extent_ = 0, reach_ = 0;  // of the smaller face, and of a part that cuts it
    Point origin_;
    Volumes found_;
};

}  // namespace liftmesh
