// What is compared: for each kind of result a hash of all its bits (FNV-1a), in the order made.
#pragma once

#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

namespace portability {

class Digest {
 public:
    void add(const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i) state_ = (state_ ^ bytes[i]) * 0x100000001b3;
        count_ += size;
    }
    template <class T>
    void add(T value) {
        add(&value, sizeof value);
    }

    std::uint64_t value() const { return state_; }
    std::size_t count() const { return count_; }

 private:
    std::uint64_t state_ = 0xcbf29ce484222325;
    std::size_t count_ = 0;
};

struct Digests {
    std::map<std::string, Digest> of;

    void print(const char* file) const {
        for (const auto& [what, digest] : of)
            std::printf("%s\t%s\t%016" PRIx64 "\t%zu\n", file, what.c_str(), digest.value(),
                        digest.count());
    }
};

// Ends the process: one build alone is wrong.
inline void demand(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "FIND: %s\n", what);
    std::exit(1);
}

}  // namespace portability
