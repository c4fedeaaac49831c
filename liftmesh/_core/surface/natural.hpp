// Heights from natural neighbours: the vertices that a point would have as neighbours if it were
// one.
//
// The faces whose circle has the point inside form a cavity without vertices (Bowyer, Watson 1981),
// found by exact in-circle tests from the face that contains the point. Its border, in order, holds
// the neighbours. Circumcentres are computed relative to the point. Weights are
//
// - of Laplace (Belikov et al. 1997): the length of the side that the point's Voronoi cell shares
//   with a neighbour, over the distance to it;
// - of Sibson (1981): the area that the cell takes from the neighbour's. It lies between the
//   circumcentres of the cell and those of the cavity's faces at the neighbour.
//
// Sums begin at the lexicographically least neighbour.
#pragma once

#include <vector>

#include "surface/relief.hpp"

namespace liftmesh {

enum class Natural : std::uint8_t { nearest, laplace, sibson };

// At a point strictly inside a face that is shown, or on a side between two. Where weights
// overflow, the height is linear.
class NaturalNeighbors {
 public:
    struct Side {
        std::int32_t face;
        int k;  // the corner opposite
    };
    struct Neighbor {
        std::int32_t row;
        Side leaving;  // the side of the border that begins at it
    };
    // Room for one point, which the next one uses again.
    struct Room {
        std::vector<Side> pending;
        std::vector<Neighbor> border;
        std::vector<Point> places, centres;  // relative to the query; of the cell, by its sides
    };

    NaturalNeighbors(const Relief& relief, Room& room)
        : relief_(relief),
          mesh_(relief.mesh()),
          pending_(room.pending),
          border_(room.border),
          places_(room.places),
          centres_(room.centres) {}

    double height(Point query, std::int32_t simplex, Natural method, Patience& patience);

 private:
    bool find_border(Point query, std::int32_t simplex, Patience& patience);
    double nearest(Point query) const;
    double laplace(std::size_t i) const;
    double sibson(std::size_t i, Point query) const;
    Point relative(std::int32_t row, Point query) const;
    Point centre_of(std::int32_t face, Point query) const;

    const Relief& relief_;
    const Triangulated& mesh_;
    std::vector<Side>& pending_;
    std::vector<Neighbor>& border_;
    std::vector<Point>&places_, &centres_;
};

}  // namespace liftmesh
