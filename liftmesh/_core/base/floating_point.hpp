// The arithmetic the kernel relies on: round to nearest, with denormal numbers, and after every
// operation. Libraries built with -ffast-math switch denormals off for a whole thread;
// `IeeeArithmetic` switches them on for a scope. A compiler that may fuse a product and a sum
// ("contraction") rounds them once where the source says twice; `contracts` tells whether it did.
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

// Whether this translation unit was compiled with contraction: the product is 1 + 2^-29 + 2^-60,
// of which a rounding keeps no 2^-60. Reading volatile variables keeps the answer for run time, and
// `static` gives each unit an answer of its own.
static inline bool contracts() {
    const volatile double factor = 1 + 0x1p-30, rounded = 1 + 0x1p-29;
    return factor * factor - rounded != 0;
}

// Throws where the caller, who hands in what `contracts` tells it, or the kernel's own sources were
// compiled with contraction: what is computed would depend on the compiler and the processor, and
// the bounds of the filters are proved for the roundings as written.
void refuse_contraction(bool caller_contracts);

}  // namespace liftmesh
