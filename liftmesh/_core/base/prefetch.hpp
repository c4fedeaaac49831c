// A request to bring memory near before it is needed.
//
// To GCC a function that does nothing but this has no effect, and calls of it are removed unless it
// is inlined first: so it must be.
#pragma once

namespace liftmesh {

[[gnu::always_inline]] inline void prefetch(const void* address) {
    __builtin_prefetch(address);
}

}  // namespace liftmesh
