// A surface to ask, some of its faces left out, and what is true of it by integers of any length.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "scatter.hpp"
#include "surface/relief.hpp"

namespace fuzzing {

// A side of a face, from tail to head with the face on the left, and what is beyond it; -1 for the
// outside and for faces that are left out.
struct Side {
    std::int32_t tail, head, beyond;
};

struct Ground {
    // Every face is left out whose corners add up to a multiple of a number, if there is one: so it
    // is for any order of the rows.
    Ground(const Scatter& scatter, const liftmesh::Delaunay& found, unsigned leaves_out);

    std::int32_t count() const { return static_cast<std::int32_t>(mesh.count); }
    Side side(std::int32_t face, int k) const;
    // Of the faces that are shown, those that contain a point.
    std::vector<std::int32_t> around(Point query) const;
    // Of these the one that contains what is infinitesimally to the right of the point, and above
    // it by infinitesimally less; or the next one counter-clockwise around the point. -1 for none.
    std::int32_t owner(Point query) const;
    // Of all vertices at the least distance, the lexicographically least.
    std::size_t nearest(Point query) const;

    const Scatter& at;
    liftmesh::Triangulated mesh;
    std::vector<std::uint8_t> left_out;
    liftmesh::Relief relief;
    mutable liftmesh::Locator locator;
};

// Heights, slopes and rasters; neighbours; lines; rings; volumes.
void check_heights(const Ground& ground, const Ground& other, Bytes& asked);
void check_lines(const Ground& ground, const Ground& other, Bytes& asked);
void check_rim(const Ground& ground, Dice& dice);
void check_volumes(const Ground& ground, const Ground& lowered);

}  // namespace fuzzing
