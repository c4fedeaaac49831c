// An interrupt that never comes, for programs that run the kernel to its end.
#pragma once

#include "base/status.hpp"

namespace native {

class Never final : public liftmesh::Interrupt {
 public:
    bool requested() override { return false; }
};

}  // namespace native
