// The arithmetic that the kernel relies on: every operation rounds to nearest, denormal numbers
// included. Libraries built with -ffast-math disable denormals for a whole thread; `IeeeArithmetic`
// enables them for a scope. A compiler that fuses a product and a sum ("contraction") rounds once
// where the source rounds twice; `contracts` detects it.
#pragma once

#include "base/standard.hpp"

#ifdef __SSE2__
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

#ifdef __FAST_MATH__
#error "liftmesh is exact only in IEEE arithmetic: build it without -ffast-math and -Ofast"
#endif
static_assert(__FLT_EVAL_METHOD__ == 0 && std::numeric_limits<double>::is_iec559,
              "the filters need doubles that are rounded after every operation");

namespace liftmesh {

#ifdef __SSE2__
// One register, in a few cycles. <cfenv> also reads and writes the state of x87, which nothing here
// uses, and takes a fifth of the time in which ten points are triangulated.
class FloatingPointState {
 public:
    FloatingPointState() : saved_(_mm_getcsr()) {}
    void set_default() const { _mm_setcsr(0x1f80); }  // all exceptions masked
    void restore() const { _mm_setcsr(saved_); }

 private:
    unsigned saved_;
};
#else
class FloatingPointState {
 public:
    FloatingPointState() { std::fegetenv(&saved_); }
    void set_default() const { std::fesetenv(FE_DFL_ENV); }
    void restore() const { std::fesetenv(&saved_); }

 private:
    std::fenv_t saved_;
};
#endif

class IeeeArithmetic {
 public:
    IeeeArithmetic() { caller_.set_default(); }
    ~IeeeArithmetic() { caller_.restore(); }
    IeeeArithmetic(const IeeeArithmetic&) = delete;
    IeeeArithmetic& operator=(const IeeeArithmetic&) = delete;

 private:
    FloatingPointState caller_;
};

// Whether this translation unit was compiled with contraction: the exact product is
// 1 + 2^-29 + 2^-60, and rounding drops 2^-60. Volatile variables defer the computation to run
// time; `static` gives each translation unit its own copy.
static inline bool contracts() {
    const volatile double factor = 1 + 0x1p-30, rounded = 1 + 0x1p-29;
    return factor * factor - rounded != 0;
}

// Throws if the caller, which passes its own `contracts()`, or the kernel was compiled with
// contraction: the arithmetic would depend on the compiler and the processor, and the error bounds
// of the filters are proved for the roundings as written.
void refuse_contraction(bool caller_contracts);

}  // namespace liftmesh
