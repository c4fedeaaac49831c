// The natural neighbours of a point: the vertices that it would have as neighbours if it were one.
//
// The faces whose circle has the point inside form a cavity without vertices (Bowyer, Watson 1981),
// found by exact in-circle tests from the face that contains the point. Its border, in order, holds
// the neighbours. Circumcentres are computed relative to the point, and scaled where squares would
// leave the doubles. Weights are
//
// - of Laplace (Belikov et al. 1997): the length of the side that the point's Voronoi cell shares
//   with a neighbour, over the distance to it;
// - of Sibson (1981): the area that the cell takes from the neighbour's. It lies between the
//   circumcentres of the cell and those of the cavity's faces at the neighbour.
//
// The border begins at the lexicographically least neighbour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

enum class Natural : std::uint8_t { nearest, laplace, sibson };

class NaturalNeighbors {
 public:
    struct Side {
        std::int32_t face;
        int k;            // the corner opposite
        std::int32_t at;  // where the face is in the cavity
    };
    struct Face {
        std::int32_t face;
        std::int32_t beside[3] = {-1, -1, -1};  // in the cavity, across the side opposite a corner
        Point centre{};                         // of its circle, relative to the query
    };
    struct Neighbor {
        std::int32_t row;
        Side leaving;  // the side of the border that begins at it
    };
    // Room for one point, which the next one uses again.
    struct Room {
        std::vector<Side> pending;
        std::vector<Face> cavity;
        std::vector<Neighbor> border;
        std::vector<Point> places, centres;  // relative to the query; of the cell, by its sides
        std::vector<double> weights;
    };

    NaturalNeighbors(const Triangulated& mesh, Room& room) : mesh_(mesh), room_(room) {}

    // Of a point strictly inside a face, or on a side between two. False if rows were written
    // meanwhile, and this was noticed.
    bool find(Point query, std::int32_t simplex, Patience& patience);

    std::size_t count() const { return room_.border.size(); }
    std::int32_t row(std::size_t i) const { return room_.border[i].row; }

    // Of several at one distance the lexicographically least.
    std::int32_t nearest() const;

    // By Laplace or by Sibson; none is negative, but their sum may be beyond the doubles, or 0.
    const std::vector<double>& weigh(Natural method);

    // Whether the border goes around the point, as it does if no row was written meanwhile.
    bool is_around() const;

    // Whether the cells of the point and of a neighbour share a side, and not a vertex only.
    bool shares_side(std::size_t i) const;

 private:
    Point place(std::int32_t row) const { return point(mesh_.place(row)); }
    std::size_t before(std::size_t i) const { return (i == 0 ? count() : i) - 1; }
    std::size_t after(std::size_t i) const { return i + 1 == count() ? 0 : i + 1; }
    void enlarge(Side side, std::int32_t face);
    void put_off(Side side);
    Point scaled(Point p) const;
    void put_places();
    void put_centres();
    double laplace(std::size_t i) const;
    double sibson(std::size_t i) const;
    Point centre_of(std::int32_t face) const;

    const Triangulated& mesh_;
    Room& room_;
    Point query_{};
    int exponent_ = 0;  // coordinates relative to the query are divided by this power of 2
};

}  // namespace liftmesh
