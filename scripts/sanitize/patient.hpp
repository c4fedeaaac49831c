// An interrupt that comes when it is asked for the n-th time.
#pragma once

#include <cstddef>

#include "base/status.hpp"

namespace parallel {

class Patient final : public liftmesh::Interrupt {
 public:
    explicit Patient(std::size_t patience = ~std::size_t{0}) : patience_(patience) {}
    bool requested() override { return asked_ >= patience_ || ++asked_ >= patience_; }

 private:
    std::size_t patience_, asked_ = 0;
};

}  // namespace parallel
