// Lets one allocation of the kernel fail: preloaded, and counted from `fail_at` on.
#include <cstdlib>
#include <new>

namespace {
long left = 0;
}

extern "C" void fail_at(long allocation) {
    left = allocation;
}

extern "C" long allocations_left() {
    return left;
}

void* operator new(std::size_t bytes) {
    if (left > 0 && --left == 0) throw std::bad_alloc();
    if (void* const memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
    throw std::bad_alloc();
}

void operator delete(void* memory) noexcept {
    std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
