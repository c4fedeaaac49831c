/* Tells callgrind, from a program that runs under it, where counting begins and ends: the requests
   are instructions that do nothing on a processor. Each `end` writes what was counted to a file of
   its own, which names the label. */

#include <valgrind/callgrind.h>

void begin(void) {
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
}

void end(const char* label) {
    CALLGRIND_DUMP_STATS_AT(label);
    CALLGRIND_STOP_INSTRUMENTATION;
}
