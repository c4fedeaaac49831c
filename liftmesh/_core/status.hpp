// What a run of the kernel came to, and how a caller can stop it.
#pragma once

#include <cstdint>

namespace liftmesh {

enum class Status : std::uint8_t { ok, non_finite, too_few, collinear, interrupted };

// Asked now and then from long runs. Once the answer is true it stays so, and the run ends with
// Status::interrupted.
class Interrupt {
 public:
    virtual ~Interrupt() = default;
    virtual bool requested() = 0;
};

}  // namespace liftmesh
