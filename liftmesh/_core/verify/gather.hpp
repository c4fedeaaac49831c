// An order of the triangles in which those that lie near one another stand near one another.
#pragma once

#include <cstdint>

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/subject.hpp"

namespace liftmesh {

struct Gathered {
    Buffer<std::int32_t> simplices;  // count x 3
    Buffer<std::uint32_t> order;     // their numbers among those of the subject
};

// Leaves `gathered` empty where the triangles are in such an order already, or are few. All corners
// must be rows. False where the interrupt came first.
bool gather(const Subject& subject, ThreadPool& pool, Gathered& gathered);

}  // namespace liftmesh
