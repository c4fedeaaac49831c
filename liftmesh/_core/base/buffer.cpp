#include "base/buffer.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace liftmesh {

namespace {

thread_local const char* folder_of_thread = nullptr;

struct Maps {
    std::mutex mutex;
    std::map<void*, std::size_t> sizes;
};

// Never destroyed: results may outlive everything else.
Maps& maps() {
    static Maps* const all = new Maps;
    return *all;
}

[[noreturn]] void fail(int code) {
    throw std::system_error(code, std::generic_category());
}

// A file that nobody else sees, and that is gone when the process ends.
int open_nameless(const char* folder) {
#ifdef O_TMPFILE
    const int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
#endif
    std::string name = std::string(folder) + "/.liftmesh-XXXXXX";
    const int named = mkstemp(name.data());
    if (named >= 0) unlink(name.c_str());
    return named;
}

int reserve(int file, std::size_t bytes) {
#ifdef __APPLE__
    return ftruncate(file, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
#else
    return posix_fallocate(file, 0, static_cast<off_t>(bytes));
#endif
}

}  // namespace

std::atomic<std::size_t> InFiles::used_ = 0;

InFiles::InFiles(const char* folder) : before_(folder_of_thread) {
    folder_of_thread = folder;
}

InFiles::~InFiles() {
    folder_of_thread = before_;
}

void* InFiles::allocate(std::size_t bytes) {
    if (folder_of_thread == nullptr) return nullptr;
    Maps& all = maps();  // before there is a map to lose
    const int file = open_nameless(folder_of_thread);
    if (file < 0) fail(errno);
    const int code = reserve(file, bytes);
    void* const memory =
        code != 0 ? MAP_FAILED : mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    const int why = code != 0 ? code : errno;
    close(file);  // the map keeps it
    if (memory == MAP_FAILED) fail(why);
    const std::lock_guard lock(all.mutex);
    try {
        all.sizes.emplace(memory, bytes);
    } catch (...) {
        munmap(memory, bytes);
        throw;
    }
    ++used_;
    return memory;
}

bool InFiles::release_mapped(void* memory) {
    Maps& all = maps();
    const std::lock_guard lock(all.mutex);
    const auto found = all.sizes.find(memory);
    if (found == all.sizes.end()) return false;
    munmap(memory, found->second);
    all.sizes.erase(found);
    --used_;
    return true;
}

bool InFiles::is_mapped(void* memory) {
    Maps& all = maps();
    const std::lock_guard lock(all.mutex);
    return all.sizes.contains(memory);
}

}  // namespace liftmesh
