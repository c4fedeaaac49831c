// Triangles of a part of a triangulation: what is wrong with them, and where they end.
//
// The argument of verify.cpp holds for parts. Pairs of half-edges cancel in whatever order they are
// found, so it is enough to pair what each part leaves unpaired; what the last part leaves is the
// boundary of the whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/input.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/flaws.hpp"

namespace liftmesh {

// An edge with its triangle on the left, and no triangle of the part on its right.
struct OpenEdge {
    std::int32_t tail, head, apex;
};

struct VerifiedPart {
    bool is_complete = false;  // the interrupt did not come first
    Flaws flaws;               // of triangles, and of the edges between them
    std::size_t interior_edges = 0;
    std::vector<OpenEdge> open;
};

// All corners must be rows, and all rows finite.
VerifiedPart verify_part(const Input& rows, const std::int32_t* simplices, std::size_t count,
                         Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
