// The arithmetic the kernel relies on: round to nearest, with denormal numbers. Libraries built
// with -ffast-math switch denormals off for a whole thread; this switches them on for a scope.
#pragma once

#include <cfenv>
#include <cfloat>
#include <limits>

#ifdef __FAST_MATH__
#error "liftmesh is exact only in IEEE arithmetic: build it without -ffast-math and -Ofast"
#endif
static_assert(FLT_EVAL_METHOD == 0 && std::numeric_limits<double>::is_iec559,
              "the filters need doubles that are rounded after every operation");

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
