// What a fuzz target does about something that does not hold.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace fuzzing {

// Ends the process unless the condition holds; the fuzzer keeps the input.
inline void demand(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "FIND: %s\n", what);
    std::abort();
}

}  // namespace fuzzing
