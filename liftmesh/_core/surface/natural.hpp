// The natural neighbours of a point: the vertices that it would have as neighbours if it were one.
//
// The faces whose circle has the point inside form a cavity without vertices (Bowyer, Watson 1981),
// found by exact in-circle tests from the face that contains the point. Its border, in order, holds
// the neighbours: each has a corner of the cavity's faces nearer to the point than to itself, so
// that none of its shares is 0. Weights are
//
// - of Laplace (Belikov et al. 1997): the length of the side that the point's Voronoi cell shares
//   with a neighbour, over the distance to it;
// - of Sibson (1981): the area that the cell takes from the neighbour's. It lies between the
//   circumcentres of the cell and those of the cavity's faces at the neighbour.
//
// They are right to 2^-40 of the largest. Circumcentres are computed in doubles, relative to the
// point and scaled where squares would leave the doubles, with bounds on their errors. Where these
// leave too much open, as in slivers at the hull or near a pair of rows, weights are sums of
// products of exact determinants, none of which is negative: two consecutive corners of the cell of
// p, the centres of (p, a, b) and (p, b, c), are
//
//     |b - p| in_circle(p, a, b, c) / 2 turn(p, a, b) turn(p, b, c)
//
// apart, and a side of this cell between p and b is
//
//     in_circle(p, a, q, b) / 2 turn(p, a, q) |b - p|
//
// away from the centre of (p, a, q). So the triangles from there to the sides, which are the area,
// have no difference left but the determinants.
//
// The border begins at the lexicographically least neighbour.
#pragma once

#include "base/pair.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "delaunay/query_order.hpp"
#include "delaunay/triangulated.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/determinants.hpp"

namespace liftmesh {

// How heights are interpolated: all but linearly by the vertices around the point. The nearest one
// is that of points in faces, or, beyond, of any point.
enum class Natural : std::uint8_t { linear, nearest, nearest_beyond, laplace, sibson };

class NaturalNeighbors {
 public:
    struct Side {
        std::int32_t face;
        int k;            // the corner opposite
        std::int32_t at;  // where the face is in the cavity
    };
    // Of a circle, relative to the query; no coordinate is off by more than the error.
    struct Centre {
        Pair at, error;
    };
    struct Face {
        std::int32_t face;
        std::int32_t beside[3] = {-1, -1, -1};  // in the cavity, across the side opposite a corner
        Centre centre{};
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
        std::vector<Point> places;    // relative to the query
        std::vector<Centre> centres;  // of the cell, by its sides
        std::vector<double> weights;
        std::vector<Scaled> exact;
    };

    NaturalNeighbors(const Triangulated& mesh, Room& room) : mesh_(mesh), room_(room) {}

    // Of a point strictly inside a face, or on a side between two. False if rows were written
    // meanwhile, and this was noticed.
    bool find(Point query, std::int32_t simplex, Patience& patience);

    std::size_t count() const { return room_.border.size(); }
    std::int32_t row(std::size_t i) const { return room_.border[i].row; }

    // By Laplace or by Sibson. None is negative, and they add up to 1 if no row was written
    // meanwhile: else they may be none.
    const std::vector<double>& weigh(Natural method);

    // Whether the border goes around the point, as it does if no row was written meanwhile.
    bool is_around() const;

 private:
    Point place(std::int32_t row) const { return point(mesh_.place(row)); }
    std::size_t before(std::size_t i) const { return (i == 0 ? count() : i) - 1; }
    std::size_t after(std::size_t i) const { return i + 1 == count() ? 0 : i + 1; }
    void enlarge(Side side, std::int32_t face);
    void put_off(Side side);
    Point scaled(Point p) const;
    void put_places();
    void put_centres();
    Centre centre_of(std::int32_t face) const;
    template <class Visit>
    void go_around(std::size_t i, const Visit& visit) const;
    struct Estimate {
        double value, error;
    };
    Estimate laplace(std::size_t i) const;
    Estimate sibson(std::size_t i) const;
    void weigh_exactly(Natural method);
    Scaled exact_laplace(std::size_t i) const;
    Scaled exact_sibson(std::size_t i) const;

    const Triangulated& mesh_;
    Room& room_;
    Point query_{};
    int exponent_ = 0;  // coordinates relative to the query are divided by this power of 2
};

}  // namespace liftmesh
