// Points from few bytes, of the kinds that make triangulations hard.
#pragma once

#include <functional>
#include <vector>

#include "base/point.hpp"
#include "bytes.hpp"

namespace fuzzing {

using liftmesh::Point;

// Makes one point after the other of the bytes that are left.
using Encoding = std::function<Point(Bytes&)>;

// Reads what the encoding needs to know before the first point.
Encoding encoding(unsigned kind, Bytes& bytes);

// Some thousand points: a tile, repeated.
std::vector<Point> tiled(Bytes& bytes);

}  // namespace fuzzing
