#include "base/floating_point.hpp"

#include <stdexcept>

namespace liftmesh {

void refuse_contraction(bool caller_contracts) {
    if (caller_contracts || contracts())
        throw std::runtime_error(
            "this build of liftmesh's kernel fuses products and sums, so it rounds otherwise than "
            "its "
            "proofs suppose: build it again with -ffp-contract=off behind all other flags, as "
            "liftmesh/_core/CMakeLists.txt has it");
}

}  // namespace liftmesh
