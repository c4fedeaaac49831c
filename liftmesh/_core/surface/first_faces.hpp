// The face that owns the position of a vertex: of the faces around it the first counter-clockwise,
// from the direction just above that of x on.
#pragma once

#include "base/status.hpp"
#include "delaunay/triangulated.hpp"

namespace liftmesh {

// Which simplices are faces: all, if there are no flags.
struct Shown {
    const std::uint8_t* left_out;

    bool has(std::int32_t simplex) const {
        return simplex >= 0 && !(left_out && left_out[simplex]);
    }
};

// Goes around a vertex from one of its triangles. -1 if none of them is shown; `unfinished` if the
// steps, one for each triangle, do not suffice.
std::int32_t first_face_around(const Triangulated& mesh, Shown shown, std::int32_t row,
                               std::int32_t simplex, std::size_t& steps);

// The same for every vertex, in one go through the triangles.
class FirstFaces {
 public:
    FirstFaces(const Triangulated& mesh, Shown shown, Patience& patience);

    std::int32_t operator[](std::int32_t row) const {
        return first_[static_cast<std::size_t>(row)];
    }

 private:
    std::vector<std::int32_t> first_;
};

}  // namespace liftmesh
