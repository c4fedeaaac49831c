// Triangles of good shape and size, by points that are added.
//
// A triangle with an angle under the bound, or that is too large, gets a point near the centre of
// its circle (L. P. Chew, "Guaranteed-quality mesh generation for curved surfaces", 1993; J.
// Ruppert, "A Delaunay refinement algorithm for quality 2-dimensional mesh generation", 1995). Of
// thin triangles it is an off-centre: no farther from their shortest edge than the bound needs (A.
// Ungor, "Off-centers", 2004). Where a constraint hides the place, or comes under a point that is
// too near, the constraint is split instead: in the middle, or, where it meets another one in a
// small angle, at a distance from there that is a power of two, so that both are split alike (J. R.
// Shewchuk, "Delaunay refinement algorithms for triangular mesh generation", 2002). If it is a
// point of that other one that came too near, the split is as far from the corner as this point:
// each finds its match, and a needle takes few points, where splits in the middle would answer each
// other along all of it. Points that no constraint needs give way to its split (Chew). Across a
// small angle between constraints no triangle is split again for its angle (G. Miller, S. Pav and
// N. Walkington, "When and why Ruppert's algorithm works", 2003); if it is too large, its longer
// constraint is split, or it gets the centre of its circle.
//
// What is shorter than 64 units in the last place of its coordinates is left: rounded points would
// come ever nearer to each other. Where triangles are to conform, circles around constraints have
// to be empty but for a margin, as float64 may have no point on the circle itself; what conforms is
// in the end decided by the test for Delaunay triangles.
//
// The triangulation is constrained Delaunay at every moment, exactly, of the points as they are
// rounded. What is next is decided by lengths, then by coordinates: so the outcome depends on the
// sets of points and constraints alone.
#pragma once

#include <functional>

#include "constrained/constrained.hpp"

namespace liftmesh::refinement {

// Of a row that was added: the piece that it divides, or none.
inline constexpr std::int32_t no_piece = -1;

// The longest edge wanted in triangles, of their centroids and regions.
using Lengths =
    std::function<void(std::span<const Point>, std::span<const std::int32_t>, double* lengths)>;

struct Wanted {
    double cosine;                    // of the least angle; 1 if none is wanted
    std::span<const double> largest;  // areas by region; none for no bound
    Lengths lengths;                  // or empty
    bool is_conforming;               // whether circles around constraints are empty, too
    std::size_t most;                 // rows to be added
    std::size_t rounds;               // of smoothing
};

// A triangulation of the convex hull. The regions of triangles are at least 0 where they are to be
// refined; what bounds these is among the pieces, which ascend.
struct Start {
    Input input;
    Constrained& mesh;  // its triangles, marks and pieces
    std::span<const std::int32_t> regions;
};

// Why a triangle has an angle under the bound, or may have one: doubles do not decide it.
enum class Cause : std::uint8_t { none, between_constraints, cap, precision };

struct Refined {
    Status status = Status::ok;
    std::vector<Point> added;           // rows after those of the input
    std::vector<std::int32_t> divided;  // the piece on which each is
    Result result;
    std::vector<std::uint8_t> marks;
    std::vector<std::int32_t> regions;  // of each triangle
    std::vector<Cause> causes;
    std::vector<std::uint8_t> is_large;  // whether each misses an area or a length
    bool is_capped = false;
};

Refined refine(const Start& start, const Wanted& wanted, Interrupt& interrupt);

}  // namespace liftmesh::refinement
