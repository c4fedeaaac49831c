// The border of the triangles: one closed curve that never turns inward, and goes round once?
#pragma once

#include <vector>

#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"
#include "verify/subject.hpp"

namespace liftmesh {

// Adds what is wrong to `flaws`. False where the interrupt came first.
bool follow_border(const Subject& subject, const std::vector<Side>& border, ThreadPool& pool,
                   Flaws& flaws);

}  // namespace liftmesh
