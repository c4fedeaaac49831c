// Counts of the steps of the procedures.
#pragma once

#include <cstdint>

namespace liftmesh::paper {

struct Counts {
    std::uint64_t calls = 0;             // of the procedure: edges wrapped around
    std::uint64_t candidate_planes = 0;  // planes (a, b, p_l) with n_z < 0
    std::uint64_t evaluations = 0;       // points held against a plane by a dot product
    std::uint64_t rejected[6] = {};      // by Propositions 4.3 (i)-(v), and 4.4
    std::uint64_t undecided = 0;         // evaluations that the exact predicate decided
};

}  // namespace liftmesh::paper
