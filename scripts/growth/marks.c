/* Tells callgrind, from a program that runs under it, where counting begins and ends: the requests
   are instructions that do nothing on a processor. Counting is started once and then goes on, since
   callgrind translates all code anew each time it is switched. Each `end` writes what was counted
   since the last `begin` to a file of its own, which names the label. */

#include <valgrind/callgrind.h>

void start(void) {
    CALLGRIND_START_INSTRUMENTATION;
}

void begin(void) {
    CALLGRIND_ZERO_STATS;
}

void end(const char* label) {
    CALLGRIND_DUMP_STATS_AT(label);
}
