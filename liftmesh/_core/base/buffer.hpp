// Large uninitialised arrays, in large pages where there are such: random access causes fewer TLB
// misses.
#pragma once

#include "base/platform.hpp"

namespace liftmesh {

// Large arrays in files of a folder: what memory does not hold becomes slow, and not impossible.
//
// While an `InFiles` lives, its thread makes large arrays as shared maps of files without a name.
// The system writes their pages to the disk when it needs the memory. All room is reserved at once,
// so that a full disk is an error at the beginning, and no bus error later.

class InFiles {
 public:
    // No folder, no files.
    explicit InFiles(const char* folder);
    ~InFiles();
    InFiles(const InFiles&) = delete;
    InFiles& operator=(const InFiles&) = delete;

    // Room in a file, or nullptr where this thread uses none. Throws std::system_error if the disk
    // fails or is full.
    static void* allocate(std::size_t bytes);

    // Whether the array was in a file, which is gone then.
    static bool release(void* memory) { return used_ != 0 && release_mapped(memory); }
    static bool holds(void* memory) { return used_ != 0 && is_mapped(memory); }

 private:
    static bool release_mapped(void* memory);
    static bool is_mapped(void* memory);

    static std::atomic<std::size_t> used_;  // arrays in files
    const char* before_;
};

// A request to bring memory near before it is needed.
//
// To GCC a function that does nothing but this has no effect, and calls of it are removed unless it
// is inlined first: so it must be.

[[gnu::always_inline]] inline void prefetch(const void* address) {
    __builtin_prefetch(address);
}

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
    constexpr std::size_t page = std::size_t{1} << 12, large = std::size_t{1} << 22;
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = std::max<std::size_t>(count * sizeof(T), 1);
    void* memory = bytes >= large ? InFiles::allocate(bytes) : nullptr;
    // malloc is several times as fast, and calls on few points make many arrays.
    if (memory == nullptr) memory = bytes < page ? std::malloc(bytes) : platform::allocate(bytes);
    if (memory == nullptr) throw std::bad_alloc();
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

// A buffer with more room, and the objects of the old one: the system moves the pages of a large
// array, and copies nothing. Not for arrays in files.
template <class T>
Buffer<T> enlarged(Buffer<T> old, std::size_t count) {
    void* larger = std::realloc(old.get(), count * sizeof(T));
    if (larger == nullptr) throw std::bad_alloc();
    static_cast<void>(old.release());
    return Buffer<T>(static_cast<T*>(larger));
}

}  // namespace liftmesh
