// What systems and standard libraries do each in their own way: large memory, files without a name,
// forks, and variables that threads share. The rest of the kernel knows no system.
#pragma once

#include "base/standard.hpp"

namespace liftmesh::platform {

// Room at the beginning of a line of the cache, and in large pages where there are such; nullptr if
// there is none. It is returned to std::realloc or std::free.
void* allocate(std::size_t bytes);

// A file without a name, mapped to memory. All its room is reserved at once.
struct Map {
    void* memory;
    std::size_t bytes;
    void* file;  // where the system needs it as long as the map
};

// Throws std::system_error, with the numbers of <cerrno>, if the disk fails or is full.
Map map_file(const char* folder, std::size_t bytes);
void unmap(const Map& map);

// Has a function called in the child of every fork, where there are forks.
bool call_in_forks(void (*function)());

// A variable that several threads change, in no order with others: std::atomic_ref, which libc++
// has from its version 19.
template <class T>
class Shared {
 public:
    explicit Shared(T& value) : value_(&value) {}

    T load() const { return __atomic_load_n(value_, __ATOMIC_RELAXED); }
    void store(T value) const { __atomic_store_n(value_, value, __ATOMIC_RELAXED); }
    T fetch_or(T bits) const { return __atomic_fetch_or(value_, bits, __ATOMIC_RELAXED); }

    // Replaces what is expected; else tells what is there, or fails for no reason.
    bool exchange(T& expected, T value) const {
        return __atomic_compare_exchange_n(value_, &expected, value, true, __ATOMIC_RELAXED,
                                           __ATOMIC_RELAXED);
    }

 private:
    T* value_;
};

}  // namespace liftmesh::platform
