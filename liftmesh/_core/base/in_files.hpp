// Large arrays in files of a folder: what memory does not hold becomes slow, and not impossible.
//
// While an `InFiles` lives, its thread makes large arrays as shared maps of files without a name.
// The system writes their pages to the disk when it needs the memory. All room is reserved at once,
// so that a full disk is an error at the beginning, and no bus error later.
#pragma once

#include <atomic>
#include <cstddef>

namespace liftmesh {

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

}  // namespace liftmesh
