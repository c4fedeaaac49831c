// An interrupt that comes when it is asked for the n-th time, and is told how far the run has come.
#pragma once

#include <atomic>
#include <cstddef>

#include "base/status.hpp"

namespace parallel {

class Patient final : public liftmesh::Interrupt {
 public:
    explicit Patient(std::size_t patience = ~std::size_t{0}) : patience_(patience) {}
    bool requested() override { return asked_ >= patience_ || ++asked_ >= patience_; }
    void expect(std::size_t work) override { expected_ = work; }
    void advance(std::size_t work) override { done_ += work; }

 private:
    std::size_t patience_, asked_ = 0, expected_ = 0;
    std::atomic<std::size_t> done_ = 0;
};

}  // namespace parallel
