// The order in which disks are inserted: a large one first, then rounds that double in size, in
// each of which neighbours are near each other (N. Amenta, S. Choi and G. Rote, "Incremental
// constructions con BRIO", SoCG 2003). Who is in which round is random.
#pragma once

#include <cstdint>
#include <vector>

#include "apollonius/disk.hpp"
#include "base/point.hpp"

namespace liftmesh::apollonius {

std::vector<Row> insertion_order(const std::vector<Disk>& disks, std::uint64_t secret);

}  // namespace liftmesh::apollonius
