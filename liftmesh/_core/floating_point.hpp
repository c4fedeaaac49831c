// The arithmetic the kernel relies on: round to nearest, with denormal numbers. Libraries built
// with -ffast-math switch denormals off for a whole thread; this switches them on for a scope.
#pragma once

#include <cfenv>

namespace liftmesh {

class IeeeArithmetic {
 public:
    IeeeArithmetic() {
        std::fegetenv(&saved_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~IeeeArithmetic() { std::fesetenv(&saved_); }
    IeeeArithmetic(const IeeeArithmetic&) = delete;
    IeeeArithmetic& operator=(const IeeeArithmetic&) = delete;

 private:
    std::fenv_t saved_;
};

}  // namespace liftmesh
