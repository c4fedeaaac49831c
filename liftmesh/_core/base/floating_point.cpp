#include "base/floating_point.hpp"

namespace liftmesh {

void refuse_contraction(bool caller_contracts) {
    if (caller_contracts || contracts())
        // GCOV_EXCL_START: tests/core/test_contraction.py builds this file with contraction
        throw std::runtime_error(
            "this build of liftmesh's kernel fuses products and sums, so the proofs of its error "
            "bounds do not hold: rebuild it with -ffp-contract=off after all other flags, as "
            "liftmesh/_core/CMakeLists.txt does");
    // GCOV_EXCL_STOP
}

}  // namespace liftmesh
