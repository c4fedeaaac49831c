// Large uninitialised arrays. On Linux they request huge pages: a page fault takes as long as
// triangulating a few points, and random access causes fewer TLB misses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "base/in_files.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace liftmesh {

struct Free {
    void operator()(void* memory) const {
        if (!InFiles::release(memory)) std::free(memory);
    }
};

template <class T>
using Buffer = std::unique_ptr<T[], Free>;

// Room for `count` objects of a type that needs no construction: in a file, if the thread is to use
// files. Throws std::bad_alloc, or what `InFiles` throws.
template <class T>
Buffer<T> allocate(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    constexpr std::size_t huge_page = std::size_t{1} << 21;
    constexpr std::size_t line = 64;
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = std::max<std::size_t>(count * sizeof(T), 1);
    const bool large = bytes >= 2 * huge_page;
    constexpr std::size_t page = std::size_t{1} << 12;
    if (bytes < page) {  // several times as fast, and calls on few points make many
        void* memory = std::malloc(bytes);
        if (memory == nullptr) throw std::bad_alloc();
        return Buffer<T>(static_cast<T*>(memory));
    }
    void* memory = large ? InFiles::allocate(bytes) : nullptr;
    if (memory != nullptr) return Buffer<T>(static_cast<T*>(memory));
    if (posix_memalign(&memory, large ? huge_page : line, bytes) != 0) throw std::bad_alloc();
#ifdef __linux__
    // Whole pages only, so that nothing beyond the array becomes resident. The system may decline.
    if (large) madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
#endif
    return Buffer<T>(static_cast<T*>(memory));
}

// Reuses the memory of a buffer for as many other objects as fit: resident memory costs no page
// fault.
template <class T, class Old>
Buffer<T> reuse(Buffer<Old> old) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignof(Old));
    return Buffer<T>(reinterpret_cast<T*>(old.release()));
}

// A buffer of `room` objects, for the first `count` of them: memory is returned where more than an
// eighth would be wasted.
template <class T, class Old>
Buffer<T> shrunk(Buffer<Old> old, std::size_t room, std::size_t count) {
    static_assert(sizeof(T) == sizeof(Old));
    Buffer<T> buffer = reuse<T>(std::move(old));
    if (count >= room - room / 8 || InFiles::holds(buffer.get())) return buffer;
    void* smaller = std::realloc(buffer.get(), std::max<std::size_t>(count * sizeof(T), 1));
    if (smaller == nullptr) return buffer;
    static_cast<void>(buffer.release());
    return Buffer<T>(static_cast<T*>(smaller));
}

}  // namespace liftmesh
