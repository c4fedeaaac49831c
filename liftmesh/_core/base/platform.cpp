#include "base/platform.hpp"

#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace liftmesh::platform {

#ifdef _WIN32

void* allocate(std::size_t bytes) {
    return std::malloc(bytes);
}

namespace {

[[noreturn]] void fail() {
    const std::error_code code(static_cast<int>(GetLastError()), std::system_category());
    throw std::system_error(code.default_error_condition().value(), std::generic_category());
}

std::wstring wide(const char* text) {
    std::wstring found(32768, L'\0');  // the longest path
    const int size =
        MultiByteToWideChar(CP_UTF8, 0, text, -1, found.data(), static_cast<int>(found.size()));
    if (size == 0) fail();
    found.resize(static_cast<std::size_t>(size - 1));
    return found;
}

// It has a name, and is gone as soon as it is closed.
HANDLE open_brief(const char* folder) {
    wchar_t name[MAX_PATH];
    if (GetTempFileNameW(wide(folder).c_str(), L"lm-", 0, name) == 0) fail();
    const HANDLE file = CreateFileW(name, GENERIC_READ | GENERIC_WRITE, 0, nullptr, CREATE_ALWAYS,
                                    FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
    if (file == INVALID_HANDLE_VALUE) fail();
    return file;
}

}  // namespace

Map map_file(const char* folder, std::size_t bytes) {
    const HANDLE file = open_brief(folder);
    const std::uint64_t size = bytes;
    const HANDLE section =
        CreateFileMappingW(file, nullptr, PAGE_READWRITE, static_cast<DWORD>(size >> 32),
                           static_cast<DWORD>(size), nullptr);
    void* const memory =
        section == nullptr ? nullptr : MapViewOfFile(section, FILE_MAP_ALL_ACCESS, 0, 0, bytes);
    const DWORD why = GetLastError();
    if (section != nullptr) CloseHandle(section);  // the map keeps it
    if (memory != nullptr) return {memory, bytes, file};
    CloseHandle(file);
    SetLastError(why);
    fail();
}

void unmap(const Map& map) {
    UnmapViewOfFile(map.memory);
    CloseHandle(map.file);
}

bool call_in_forks(void (*)()) {
    return false;
}

#else

// A page fault takes as long as triangulating a few points.
void* allocate(std::size_t bytes) {
    constexpr std::size_t huge_page = std::size_t{1} << 21, line = 64;
    const bool large = bytes >= 2 * huge_page;
    void* memory = nullptr;
    if (posix_memalign(&memory, large ? huge_page : line, bytes) != 0) return nullptr;
#ifdef MADV_HUGEPAGE
    // Whole pages only, so that nothing beyond the array becomes resident. The system may decline.
    if (large) madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
#endif
    return memory;
}

namespace {

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

Map map_file(const char* folder, std::size_t bytes) {
    const int file = open_nameless(folder);
    if (file < 0) fail(errno);
    const int code = reserve(file, bytes);
    void* const memory =
        code != 0 ? MAP_FAILED : mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    const int why = code != 0 ? code : errno;
    close(file);  // the map keeps it
    if (memory == MAP_FAILED) fail(why);
    return {memory, bytes, nullptr};
}

void unmap(const Map& map) {
    munmap(map.memory, map.bytes);
}

bool call_in_forks(void (*function)()) {
    return pthread_atfork(nullptr, nullptr, function) == 0;
}

#endif

}  // namespace liftmesh::platform
