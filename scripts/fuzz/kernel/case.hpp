// What the fuzzer's bytes say: rows for the kernel, and what is to be done with them.
//
// Three bytes stand at the head: the encoding of the points, how they lie in memory and on how many
// threads, and which check follows. The rest are points, in one of several encodings, for bytes
// that are doubles hardly ever meet on a circle. 255 as the first byte and T as the fourth ask for
// thousands of points, made of a tile: fewer never reach a second thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/input.hpp"
#include "base/point.hpp"
#include "bytes.hpp"
#include "parallel/thread_pool.hpp"
#include "predicates/orient3d.hpp"

namespace fuzzing {

using liftmesh::Point;
using liftmesh::SpacePoint;

enum class Check : std::uint8_t {
    lf,
    lfres,
    lfres_indexed,
    location,
    predicates,
    lower_hull,
    verification,
    interruption
};

struct Case {
    Check check;
    bool skip_non_finite;
    liftmesh::Threads threads;
    std::vector<SpacePoint> points;  // as stored: rounded, where that is in single precision
    std::unique_ptr<std::byte[]> memory;
    liftmesh::Input input;
    Dice dice;             // for choices that a check makes
    bool with_family;      // weights, radii, a metric and the farthest site, too
    bool is_wide = false;  // so many magnitudes that signs take the longest integers

    std::size_t rows() const { return points.size(); }
    Point point(std::size_t row) const { return points[row].planar(); }
    bool is_large() const { return rows() > 600; }
};

Case decode(Bytes bytes);

}  // namespace fuzzing
