#include "base/buffer.hpp"

namespace liftmesh {

namespace {

thread_local const char* folder_of_thread = nullptr;

struct Maps {
    std::mutex mutex;
    std::map<void*, platform::Map> by_memory;
};

// Never destroyed: results may outlive everything else.
Maps& maps() {
    static Maps* const all = new Maps;
    return *all;
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
    const platform::Map map = platform::map_file(folder_of_thread, bytes);
    const std::lock_guard lock(all.mutex);
    try {
        all.by_memory.emplace(map.memory, map);
    } catch (...) {
        platform::unmap(map);
        throw;
    }
    ++used_;
    return map.memory;
}

bool InFiles::release_mapped(void* memory) {
    Maps& all = maps();
    const std::lock_guard lock(all.mutex);
    const auto found = all.by_memory.find(memory);
    if (found == all.by_memory.end()) return false;
    platform::unmap(found->second);
    all.by_memory.erase(found);
    --used_;
    return true;
}

bool InFiles::is_mapped(void* memory) {
    Maps& all = maps();
    const std::lock_guard lock(all.mutex);
    return all.by_memory.contains(memory);
}

}  // namespace liftmesh
